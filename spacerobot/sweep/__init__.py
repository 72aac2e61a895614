"""Monte-Carlo capture campaigns: poses x speeds x masses x springs, with scatter, written as Parquet."""
