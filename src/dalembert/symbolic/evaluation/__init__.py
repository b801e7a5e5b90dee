"""Numerical evaluation of graph functions: virtual machine, machine code, lanes and threads."""
