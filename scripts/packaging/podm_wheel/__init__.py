"""Links the programs and the extension module again, so that they run with an older C library and need no other package
of the system, and puts them into a wheel."""
