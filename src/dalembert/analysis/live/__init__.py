"""Analyses as WebAssembly modules, for pages that compute."""
