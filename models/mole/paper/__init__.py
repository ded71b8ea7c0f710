"""The paper's claims compared with the model, in `table`; nothing else needs it."""
