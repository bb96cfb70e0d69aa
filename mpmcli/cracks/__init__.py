"""Explicit cracks in the plane: chains of massless points that cut velocity fields (Nairn 2003)."""
