"""Parameter studies: tables of designs, workers, storage, indices and surrogates."""
