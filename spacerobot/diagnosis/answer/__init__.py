"""What is said: verdict, evidence, next trial, the mended model."""
