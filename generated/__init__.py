"""Generated models, one package each."""
