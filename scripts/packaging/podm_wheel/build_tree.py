"""A build folder as Ninja knows it."""
import json
import re
import shlex
import subprocess


class BuildTree:
    def __init__(self, folder):
        self.folder = folder

    def parts_of(self, output):
        """Returns the object files and the archives that the project itself gives to the linker of `output`."""
        query = subprocess.run(["ninja", "-C", self.folder, "-t", "query", output], check=True, capture_output=True,
                               text=True).stdout
        inputs = query.partition("  outputs:\n")[0]
        parts = dict.fromkeys(re.findall(r"^    (?:\| )?([^|/\s]\S*\.(?:o|a))$", inputs, re.MULTILINE))
        return [self.folder / part for part in parts]

    def compile_commands(self, suffix):
        """Returns the arguments that compile each source of a target, without the output; `suffix` ends the folder of
        the target's object files."""
        commands = json.loads((self.folder / "compile_commands.json").read_text())
        found = []
        for command in commands:
            words = shlex.split(command["command"])
            place = words.index("-o")
            if f"/{suffix}/" in "/" + words[place + 1]:
                found.append(words[:place] + words[place + 2:])
        return found

    def version(self):
        cache = (self.folder / "CMakeCache.txt").read_text()
        return re.search(r"^CMAKE_PROJECT_VERSION:STATIC=(.+)$", cache, re.MULTILINE)[1]
