"""The same collision in several engines: elastic contact spring, wrist spring and damper, a free target."""
