"""Motion of mechanisms under forces, from the start to the judgement of a run."""
