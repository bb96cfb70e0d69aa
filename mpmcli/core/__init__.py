"""Arrays, kernels, transfer operators and what every other room shares."""
