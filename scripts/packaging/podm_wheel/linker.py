"""Links object files of the build with the libraries that scripts/packaging/libraries has made."""
import shutil
import subprocess

from .binary import soname

SYSTEM = "/usr/lib/x86_64-linux-gnu"
# Debian's archives that are position-independent; the others are in static/.
OF_DEBIAN = ("libboost_thread.a", "libboost_context.a", "libboost_atomic.a", "libarchive.a", "libcrypto.a", "libz.a")


class Linker:
    def __init__(self, libraries, output):
        """`libraries` is the folder of scripts/packaging/libraries. `output` is the folder libs/ of the wheel."""
        self.libraries = libraries
        self.bundled = self._bundle(output)

    def _bundle(self, output):
        """Copies the shared libraries under names that no other library has: a process that also loads the system's
        own copy, or that of another wheel, keeps both apart."""
        output.mkdir(parents=True)
        names = {path: path.name.replace(".so", "-podmark.so")
                 for path in sorted((self.libraries / "bundled").glob("*.so"))}
        originals = {soname(path): name for path, name in names.items()}
        for path, name in names.items():
            copy = output / name
            shutil.copy(path, copy)
            copy.chmod(0o755)
            subprocess.run(["strip", "--strip-unneeded", copy], check=True)
            # patchelf 0.14 writes all names of one call to the same place: each call changes one.
            for change in (["--set-soname", name], ["--set-rpath", "$ORIGIN"],
                           *(["--replace-needed", *pair] for pair in originals.items())):
                subprocess.run(["patchelf", *change, copy], check=True)
        return sorted(output.iterdir())

    def program(self, parts, output, libs):
        self._link(["-pie", "-o", output, f"-Wl,-rpath,$ORIGIN/{libs}"], parts)

    def module(self, parts, output, libs):
        """Links an extension module, which shows nothing but its entry."""
        visible = output.with_suffix(".map")
        visible.write_text("{ global: PyInit__podm; local: *; };\n")
        self._link(["-shared", "-Wl,--exclude-libs,ALL", f"-Wl,--version-script={visible}", "-Wl,-z,undefs", "-o",
                    output, f"-Wl,-rpath,$ORIGIN/{libs}"], parts)  # Python has the other symbols
        visible.unlink()

    def _link(self, options, parts):
        root = self.libraries / "sysroot"
        archives = [*sorted((self.libraries / "static").glob("*.a")), *(f"{SYSTEM}/{name}" for name in OF_DEBIAN)]
        command = ["g++", f"--sysroot={root}", f"-B{root / 'usr/lib/x86_64-linux-gnu'}/", "-static-libstdc++",
                   "-static-libgcc", f"-L{self.libraries / 'static'}", "-s", "-Wl,--gc-sections", "-Wl,--as-needed",
                   "-Wl,-z,defs", "-Wl,-z,relro,-z,now", *options, self.libraries / "older_glibc.o",
                   "-Wl,--start-group", *parts, *archives, "-Wl,--end-group",  # libraries of ITK refer to each other
                   *self.bundled, "-pthread", "-ldl", "-lrt", "-lm"]
        subprocess.run(command, check=True)
