#!/bin/sh
# The compiler of the probe alone, asked for the frame of every function: with fat link-time
# optimisation it compiles them all. The option needs RUSTC_BOOTSTRAP on a stable compiler.
RUSTC_BOOTSTRAP=1 exec "$@" -Zemit-stack-sizes
