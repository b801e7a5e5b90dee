"""Compilation of graph functions to machine code, by LLVM in memory or by a C compiler."""
