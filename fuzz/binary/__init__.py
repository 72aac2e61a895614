"""Binary files whose parser is not ours: structured mutation, each case parsed as the product does, in a child."""
