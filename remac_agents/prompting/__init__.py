"""What roles that are filled by language models share: prompts, the models behind them, and how they are asked."""
