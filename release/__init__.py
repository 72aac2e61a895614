"""What is checked before a release: licences, known vulnerabilities, builds that repeat; `make release-check`."""
