"""What a command needs, what of it is missing, and how it gets here (packages.txt)."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from setup import ROOT, Failure, process, say

CMAKE = (3, 24)  # earlier ones have no file sets that are verified
SYSTEM_PYTHON = "/usr/bin/python3"  # the distribution's modules belong to it
VERSIONS = "CMake must be 3.24 or later, the compiler must know C++20."


@dataclass(frozen=True)
class Need:
    kind: str
    name: str
    apt: str
    brew: str
    conda: str
    commands: tuple

    def wanted_by(self, command):
        return command in self.commands or self.optional_for(command)

    def optional_for(self, command):
        return command + "?" in self.commands


def read_table(file=ROOT / "setup" / "packages.txt"):
    rows = [line.split("|") for line in Path(file).read_text(encoding="utf-8").splitlines()
            if line and not line.startswith("#")]
    return [Need(*(cell.strip() for cell in row[:5]), tuple(row[5].split())) for row in rows]


# --------------------------------------------------------------------------------------------------
# What is missing


def has_cmake():
    match = re.search(r"version (\d+)\.(\d+)", process.output(["cmake", "--version"]) or "")
    return bool(match) and (int(match[1]), int(match[2])) >= CMAKE


def compiles(compiler, text, *options):
    """Whether a compiler takes a C++ text."""
    return process.output([compiler, "-x", "c++", *options, "-"], input=text) is not None


def has_compiler():
    asked = os.environ.get("CXX")
    candidates = [asked] if asked else ["c++", "g++", "clang++"]
    return any(compiles(candidate, "#include <concepts>\n", "-std=c++20", "-fsyntax-only")
               for candidate in candidates)


def has_libfuzzer():
    """Linking tells: the compiler takes the flag without the library too."""
    with tempfile.TemporaryDirectory() as folder:
        return compiles("clang++", 'extern "C" int LLVMFuzzerTestOneInput(const char*, long) '
                        "{ return 0; }\n", "-fsanitize=fuzzer,address", "-o", f"{folder}/probe")


TOOLS = {"python": lambda: True, "cmake": has_cmake, "c++": has_compiler,
         "make": lambda: bool(os.environ.get("CMAKE_GENERATOR") or shutil.which("make")),
         "libFuzzer": has_libfuzzer}

BASIC = {"cmake", "c++", "make"}  # without these nothing is known of the packages


def unknown_to_cmake(packages):
    """Those of the packages that CMake does not find."""
    if not packages:
        return []
    build = ROOT / "build" / "find_packages"
    search = ["cmake", "-S", ROOT / "cmake" / "find_packages", "-B", build,
              "-DPACKAGES=" + ";".join(packages)]
    with open_log("find_packages") as log:
        if all(process.call(command, stdout=log, stderr=subprocess.STDOUT)
               for command in (search, [*search, "--fresh"])):
            log.seek(0)
            raise Failure("CMake does not work with this compiler:\n" + log.read())
    return (build / "missing.txt").read_text(encoding="utf-8").split()


def imports(python, modules):
    return process.output([python, "-c", "import " + ", ".join(modules)]) is not None


def python_with(modules):
    """The first Python that has all of the modules, or None."""
    return next((python for python in (SYSTEM_PYTHON, sys.executable, "python3")
                 if imports(python, modules)), None)


def missing_for(command):
    """The needs of a command that are not met. Without CMake and compiler nothing is known of the
    packages; then all of them are in the answer."""
    needs = [need for need in read_table() if need.wanted_by(command)]
    missing = [need for need in needs if need.kind == "tool" and not TOOLS[need.name]()
               or need.kind == "program" and not shutil.which(need.name)]
    packages = [need for need in needs if need.kind == "package"]
    if not BASIC & {need.name for need in missing}:
        unknown = unknown_to_cmake([need.name for need in packages])
        packages = [need for need in packages if need.name in unknown]
    missing += packages
    modules = [need for need in needs if need.kind == "module"]
    if modules and not python_with([need.name for need in modules]):
        missing += [need for need in modules if not imports(SYSTEM_PYTHON, [need.name])]
    return missing


# --------------------------------------------------------------------------------------------------
# Installing


def right_to_install():
    """How apt-get is called here and in whose right, or None where it is not to be called."""
    if os.environ.get("CROSSBEAM_NO_INSTALL") or not os.path.exists("/etc/debian_version"):
        return None
    if not shutil.which("apt-get"):
        return None
    if os.geteuid() == 0:
        return [], "as root"
    if not shutil.which("sudo"):
        return None
    if not sys.stdin or not sys.stdin.isatty():
        if process.output(["sudo", "-n", "true"]) is None:  # it would ask for a password
            return None
    return ["sudo"], "with sudo"


def install(needs, right):
    packages = sorted({package for need in needs for package in need.apt.split()})
    prefix, whose = right
    say(f"Missing: {', '.join(need.name for need in needs)}.\n"
        f"Installing with apt-get, {whose}: {' '.join(packages)}\n"
        "(CROSSBEAM_NO_INSTALL=1 prevents it; log: build/install.log)")
    apt_get = [*prefix, "env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-y", "-o",
               "DPkg::Lock::Timeout=300"]
    command = [*apt_get, "install", "--no-install-recommends", *packages]
    with open_log("install") as log:
        def attempt(words):
            # In the foreground: sudo may ask for a password at the terminal.
            return subprocess.run(words, stdout=log, stderr=subprocess.STDOUT, check=False).returncode
        # The package lists may be absent or old: they are fetched only if the installation needs it.
        if attempt(command) and (attempt([*apt_get, "update"]) or attempt(command)):
            log.seek(0)
            raise Failure("".join(log.readlines()[-30:]) + "apt-get could not install "
                          + " ".join(packages))


def named(needs):
    """The needs as three package managers call them."""
    return "\n".join(f"  {need.name:<14} apt: {need.apt:<24} brew: {need.brew:<18} "
                     f"conda: {need.conda}" for need in needs)


def require(command):
    """Sees to it that a command has what it needs: installs or names what is missing. Returns the
    names of what it has to do without."""
    missing = missing_for(command)
    right = right_to_install()
    if missing and right:
        try:
            install(missing, right)
        except Failure as failure:
            if any(not need.optional_for(command) for need in missing):
                raise
            say(failure, "\nGoing on without.")
        missing = missing_for(command)
    needed = [need for need in missing if not need.optional_for(command)]
    if needed:
        what = "still not found after installing" if right else "and not to be installed from here"
        raise Failure(f"missing, {what}:\n{named(needed)}\nInstall them with one of these package "
                      f"managers, then run the command again.\n({VERSIONS})")
    return {need.name for need in missing}


def open_log(name):
    """build/<name>.log, to be written and read."""
    folder = ROOT / "build"
    try:
        folder.mkdir(exist_ok=True)
        return open(folder / f"{name}.log", "w+", encoding="utf-8", errors="replace")
    except OSError as error:
        raise Failure(f"cannot write to {folder}: {error.strerror}. The commands build in the "
                      "repository's own folder: take a copy that you may write to.") from error
