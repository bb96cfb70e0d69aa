"""Interfaces: surfaces that transmit tractions across a jump of displacement; one law per file."""
