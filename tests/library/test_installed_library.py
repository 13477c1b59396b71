"""The library as a stranger uses it: installed, found by CMake and pkg-config, built against from other projects."""

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from installed import examples, prefix

from build_tree import ROOT, one_at_a_time, run
from pilotfish import data

pytestmark = [
    pytest.mark.builds,
    pytest.mark.not_sanitized("a stranger's program is linked without the sanitizer's runtime"),
]
CONSUMER = Path(__file__).parent / "consumer"
HEADERS = sorted(str(file.relative_to(ROOT / "include")) for file in (ROOT / "include").rglob("*.hpp"))
EXAMPLES = sorted(file.stem for file in (ROOT / "examples/cpp").glob("*.cpp"))
TWINS = sorted(file.stem for file in (ROOT / "examples/python").glob("*.py"))


@pytest.fixture(scope="session")
def pictures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pictures")
    run(sys.executable, "-m", "pilotfish", "render", data.path("scenarios/line.yaml"), "--out", folder, "--frames", "5")
    return folder


def configure(source, build, *options, environment=None):
    return subprocess.run(
        ["cmake", "-S", str(source), "-B", str(build), "-G", "Ninja", *map(str, options)],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | (environment or {}),
    )


def test_every_public_header_is_installed():
    installed = {str(file.relative_to(prefix() / "include")) for file in (prefix() / "include").rglob("*.hpp")}
    assert installed == set(HEADERS)


def test_a_project_finds_the_component_that_it_names(tmp_path):
    done = configure(CONSUMER, tmp_path, f"-DCMAKE_PREFIX_PATH={prefix()}", "-DCOMPONENTS=fuzzy")
    assert done.returncode == 0, done.stderr
    run("cmake", "--build", tmp_path)
    assert run(tmp_path / "consumer") == "0.50\n"


def test_a_component_that_is_not_there_is_named_beside_those_that_are(tmp_path):
    done = configure(CONSUMER, tmp_path, f"-DCMAKE_PREFIX_PATH={prefix()}", "-DCOMPONENTS=fuzzi")
    assert done.returncode != 0
    assert "no component 'fuzzi', only core, fuzzy, vision" in " ".join(done.stderr.split())


def test_the_source_tree_as_a_part_of_another_project_builds_what_that_asks_for_and_installs_nothing(tmp_path):
    # New each time, and always at one place: the same commands as last time are what ccache knows.
    build = ROOT / "build" / "part-of-another-project"
    with one_at_a_time(build.with_name(f"{build.name}.lock")):
        shutil.rmtree(build, ignore_errors=True)
        done = configure(
            CONSUMER, build, f"-DPILOTFISH_SOURCE={ROOT}", "-DCOMPONENTS=fuzzy", "-DPILOTFISH_COMPONENTS=fuzzy"
        )
        assert done.returncode == 0, done.stderr
        run("cmake", "--build", build)
        assert run(build / "consumer") == "0.50\n"
        run("cmake", "--install", build, "--prefix", tmp_path / "prefix")
    assert not list((tmp_path / "prefix").rglob("*.hpp"))


def test_pkg_config_is_enough_without_cmake(tmp_path):
    environment = os.environ | {"PKG_CONFIG_PATH": str(prefix() / "lib/pkgconfig")}
    flags = subprocess.run(
        ["pkg-config", "--cflags", "--libs", "pilotfish-fuzzy"],
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    ).stdout.split()
    run("c++", "-std=c++17", CONSUMER / "consumer.cpp", *flags, "-o", tmp_path / "consumer")
    assert run(tmp_path / "consumer") == "0.50\n"


@pytest.mark.parametrize(
    ("components", "there_is"), [("fuzzy", []), ("core", ["eigen3"]), ("fuzzy;vision", ["eigen3", "apriltag"])]
)
def test_what_a_component_does_not_need_is_not_needed_to_configure_it(tmp_path, components, there_is):
    """A machine on which pkg-config knows nothing else, and CMake is told that the other packages are not there."""
    absent = ["yaml-cpp", "spdlog", "CLI11", "nlohmann_json", "OpenCV", "VISP", "Threads"]
    if "eigen3" not in there_is:
        absent.append("Eigen3")
    known = tmp_path / "pkgconfig"
    known.mkdir()
    for name in there_is:
        folder = run("pkg-config", "--variable=pcfiledir", name).strip()
        (known / f"{name}.pc").write_text((Path(folder) / f"{name}.pc").read_text())
    done = configure(
        ROOT,
        tmp_path / "build",
        f"-DPILOTFISH_COMPONENTS={components}",
        *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in absent),
        environment={"PKG_CONFIG_LIBDIR": str(known), "PKG_CONFIG_PATH": ""},
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("component", "absent", "package"),
    [
        ("core", "Eigen3", "libeigen3-dev"),
        ("config", "yaml-cpp", "libyaml-cpp-dev"),
        ("capture", "OpenCV", "libopencv-dev"),
    ],
)
def test_what_is_missing_is_named_with_its_debian_package(tmp_path, component, absent, package):
    done = configure(ROOT, tmp_path, f"-DPILOTFISH_COMPONENTS={component}", f"-DCMAKE_DISABLE_FIND_PACKAGE_{absent}=ON")
    assert done.returncode != 0
    assert f"apt-get install {package}" in " ".join(done.stderr.split())


def test_a_component_that_does_not_exist_is_refused_by_name(tmp_path):
    done = configure(ROOT, tmp_path, "-DPILOTFISH_COMPONENTS=visions")
    assert done.returncode != 0
    assert "there is no 'visions'; choose from core, fuzzy, vision" in " ".join(done.stderr.split())


def test_an_optional_component_that_lacks_something_is_only_not_found(tmp_path):
    options = [f"-DCMAKE_PREFIX_PATH={prefix()}", "-DCOMPONENTS=fuzzy", "-DOPTIONAL_COMPONENTS=core;vision;capture"]
    done = configure(CONSUMER, tmp_path, *options, "-DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON")
    assert done.returncode == 0, done.stderr
    for line in ("core: TRUE", "vision: TRUE", "capture: FALSE"):
        assert line in done.stdout
    # What stands on it is not found either, and what is required still stops the configuration.
    done = configure(CONSUMER, tmp_path / "2", *options, "-DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON")
    assert done.returncode == 0, done.stderr
    for line in ("core: FALSE", "vision: FALSE", "capture: FALSE"):
        assert line in done.stdout
    options += ["-DCOMPONENTS=vision", "-DOPTIONAL_COMPONENTS=capture"]
    done = configure(CONSUMER, tmp_path / "3", *options, "-DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON")
    assert done.returncode != 0
    assert "apt-get install libeigen3-dev" in " ".join(done.stderr.split())


@pytest.mark.parametrize(
    ("component", "absent", "others"),
    [("core", "Eigen3", "fuzzy"), ("capture", "OpenCV", "core;fuzzy;vision;visp;control;coordinator;jpeg;bus;base")],
)
def test_what_is_suggested_instead_does_without_what_is_missing(tmp_path, component, absent, others):
    lacking = f"-DCMAKE_DISABLE_FIND_PACKAGE_{absent}=ON"
    done = configure(ROOT, tmp_path, f"-DPILOTFISH_COMPONENTS={component}", lacking)
    assert f'PILOTFISH_COMPONENTS="{others}"' in " ".join(done.stderr.split())
    done = configure(ROOT, tmp_path / "2", f"-DPILOTFISH_COMPONENTS={others.replace('visp;', '')}", lacking)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("option", ["PILOTFISH_APPS", "PILOTFISH_PYTHON", "PILOTFISH_TESTS", "PILOTFISH_BENCH"])
def test_what_needs_more_modules_than_are_built_is_refused_at_once(tmp_path, option):
    done = configure(ROOT, tmp_path, "-DPILOTFISH_COMPONENTS=fuzzy", f"-D{option}=ON")
    assert done.returncode != 0
    assert f"({option}) need modules that PILOTFISH_COMPONENTS leaves out: core;vision" in " ".join(done.stderr.split())


def test_an_empty_list_of_components_is_refused_and_all_may_stand_among_them(tmp_path):
    done = configure(ROOT, tmp_path, "-DPILOTFISH_COMPONENTS=")
    assert done.returncode != 0
    assert "PILOTFISH_COMPONENTS names no module" in " ".join(done.stderr.split())
    options = ["-DPILOTFISH_APPS=OFF", "-DPILOTFISH_PYTHON=OFF"]
    done = configure(ROOT, tmp_path / "2", "-DPILOTFISH_COMPONENTS=fuzzy;all", *options)
    assert done.returncode == 0, done.stderr


def test_the_commands_of_the_guides_configure_without_any_python_package(tmp_path):
    """Of /usr/bin/python3, as on a machine on which scripts/setup has not run."""
    for guide in ("docs/library.md", "examples/README.md"):
        commands = [line.strip() for line in (ROOT / guide).read_text().splitlines() if "-B build/library" in line]
        assert len(commands) == 2, guide
        for number, command in enumerate(commands):
            words = shlex.split(command.partition("&&")[0].replace("~/", f"{tmp_path}/"))
            options = [word for word in words if word.startswith("-D")]
            build = tmp_path / f"{Path(guide).stem}{number}"
            done = configure(ROOT, build, *options, "-DPython_EXECUTABLE=/usr/bin/python3")
            assert done.returncode == 0, f"{command}: {done.stderr}"


def test_every_example_is_short_and_has_a_twin():
    for file in [*(ROOT / "examples/cpp").glob("*.cpp"), *(ROOT / "examples/python").glob("*.py")]:
        assert len(file.read_text().splitlines()) < 60, file.name
    assert set(EXAMPLES) - set(TWINS) <= {"visp_servo"}  # ViSP has no Python package on Debian
    assert set(TWINS) <= set(EXAMPLES)


def twin(name, *arguments):
    return run(sys.executable, ROOT / f"examples/python/{name}.py", *arguments).splitlines()


@pytest.mark.parametrize("name", ["fuzzy_controller", "own_law"])
def test_the_twins_say_the_same(name):
    said = run(examples() / name).splitlines()
    assert said == twin(name)
    assert len(said) >= 7


def test_the_fuzzy_example_closes_its_gap_to_one_metre():
    assert "1.0" in run(examples() / "fuzzy_controller").splitlines()[-1].split(" m behind")[0]


def test_the_tracking_twins_see_the_tag_in_every_picture(pictures):
    said = run(examples() / "track_images", pictures, 600, 0.16).splitlines()
    assert said == twin("track_images", pictures, 600, 0.16)
    assert len(said) == 5
    assert all(" m, bearing " in line for line in said)


def test_the_following_twins_drive_and_stop_when_the_pictures_do(pictures):
    config = data.path("config/line.yaml")
    said = run(examples() / "follow_without_lcm", config, pictures).splitlines()
    assert said == twin("follow_without_lcm", config, pictures)
    assert [line.split()[2] for line in said[:5]] == ["tracking"] * 5
    assert said[-1] == "later:   lost      v = +0.000 m/s"
