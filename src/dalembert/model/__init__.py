"""Mechanism models: builder, equations of motion, assembly and diagnosis."""
