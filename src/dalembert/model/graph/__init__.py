"""Models of mechanisms: graphs of their equations of motion, assembly and diagnosis."""
