"""Arrays, kernels, transfer operators and what every other room shares."""

from mpmcli.core.runtime import configure

configure()
