"""Translation of input files of other programs into scenes."""
