"""CVODES and IDAS of the SUNDIALS suite."""
