"""Models as functional mock-up units (FMI 3.0 and 2.0), in C generated from their equations."""
