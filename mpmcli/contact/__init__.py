"""Contact between velocity fields: contact nodes, fields in contact, normals and separations, laws and impulses."""
