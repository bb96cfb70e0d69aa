"""Contact between velocity fields: who meets whom, the geometry of meeting, and the momentum that changes hands."""
