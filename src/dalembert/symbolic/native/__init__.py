"""Functions of the graph as machine code: by LLVM in memory, or by a C compiler."""
