"""Compiling and running kernels: decorators, dispatch by type, the disk cache, threads."""
