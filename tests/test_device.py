"""LLVM is found or refused with a sentence, uploads do not borrow memory, and a user's Mitsuba variant stays."""

import subprocess
import sys
from pathlib import Path

import drjit as dr
import numpy as np
import pytest

import radiosity as rd
from radiosity.device import launches as blocks
from radiosity.device import llvm
from radiosity.device.backend import PACKET, choose, small, upload


def python(code: str, **environment) -> subprocess.CompletedProcess:
    import os

    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=os.environ | environment, timeout=300)


def test_old_or_broken_libraries_are_refused(tmp_path, monkeypatch):
    broken = tmp_path / "libLLVM.so"
    broken.write_bytes(b"not a library")
    monkeypatch.setenv(llvm.VARIABLE, str(broken))
    with pytest.raises(rd.DeviceError, match=r"no loadable libLLVM; install"):
        llvm.find()
    monkeypatch.setattr(llvm, "version", lambda path: 15)
    with pytest.raises(rd.DeviceError, match=rf"libLLVM 15 .* is too old; install .* set {llvm.VARIABLE}"):
        llvm.find()
    monkeypatch.delenv(llvm.VARIABLE)
    monkeypatch.setattr(llvm, "_folders", list)
    with pytest.raises(rd.DeviceError, match="no usable libLLVM found"):
        llvm.find()


def test_a_broken_setting_is_one_sentence_not_a_crash(tmp_path):
    code = (
        "import radiosity as rd\n"
        "try:\n rd.solve(rd.load_scene('room'), rays=10**5)\n"
        "except rd.DeviceError as error: print('refused', error)"
    )
    done = python(code, **{llvm.VARIABLE: str(tmp_path / "libLLVM.so")})
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("refused")


def test_the_users_own_library_wins():
    chosen = llvm.find()
    assert llvm.version(Path(chosen.path)) >= llvm.OLDEST


def test_the_users_setting_is_told_from_our_own(tmp_path):
    """The package sets the variable itself as it is imported, and a child process inherits that."""
    inherited = {llvm.VARIABLE: llvm.POINTED} if llvm.POINTED else {}
    origin = "print(llvm.prepare().origin)\n"
    told = f"import radiosity\nfrom radiosity.device import llvm\n{origin}import drjit\n{origin}"
    origins = set(python(told, **inherited).stdout.split())
    assert len(origins) == 1
    assert origins == ({llvm.find().origin} if llvm.POINTED else {llvm.VARIABLE})
    found = llvm.find().path
    (tmp_path / "mine").symlink_to(found.parent)
    assert python(told, **{llvm.VARIABLE: str(tmp_path / "mine" / found.name)}).stdout.split() == [llvm.VARIABLE] * 2


def test_a_broken_library_that_we_chose_is_not_called_a_setting(tmp_path, monkeypatch):
    broken = tmp_path / "libLLVM.so.99"
    broken.write_bytes(b"not a library")
    monkeypatch.setattr(llvm, "_folders", lambda: [(tmp_path, "system")])
    monkeypatch.setattr(llvm, "_pattern", lambda: "libLLVM*")
    monkeypatch.setattr(llvm, "POINTED", str(broken))
    monkeypatch.setenv(llvm.VARIABLE, str(broken))
    with pytest.raises(rd.DeviceError, match=r"^no usable libLLVM found"):
        llvm.find()


def test_a_few_numbers_are_copied_whole():
    """No number is rounded, and none becomes a constant of a kernel: gathers read an array, whatever the numbers."""
    types = choose("cpu").types
    for kind, values in (
        (types.Float64, np.array([[0.1, 1 / 3], [1e300, -(2.0**-1000)]])),
        (types.Float64, np.array([0.1])),
        (types.UInt64, [2**63 + 1]),
        (types.UInt32, [7] * 5),
    ):
        array = small(kind, values)
        assert array.state is dr.VarState.Evaluated
        assert np.array(array).tolist() == [*np.ravel(values).tolist(), 0]


def test_uploads_are_copies_and_padded():
    types = choose("cpu").types
    for length in (1, PACKET - 1, PACKET, PACKET + 1, 4096):
        values = np.arange(length, dtype=np.uint32)
        array = upload(types.UInt32, values)
        values[:] = 7
        assert np.array_equal(np.array(array), np.arange(length))


@pytest.fixture(scope="module")
def with_a_variant() -> dict[str, list[str]]:
    """What a program tells whose user has set a variant, by the first word of a line."""
    code = (
        "import radiosity as rd, mitsuba as mi, drjit.ast, warnings\n"
        "mi.set_variant('scalar_rgb')\n"
        "assert drjit.ast._syntax_counter > 0\n"
        "before, drjit.ast._syntax_counter = drjit.ast._syntax_counter, 1000\n"
        "warnings.simplefilter('error')\n"
        "scene = rd.load_scene('room')\n"
        "patches = rd.subdivide(scene, cells=2)\n"
        "print('warnings', rd.solve(patches, rays=10**5).status, drjit.ast._syntax_counter > 1000)\n"
        "warnings.resetwarnings()\n"
        "drjit.ast._syntax_counter = before\n"
        "from radiosity.tracing.first_hits import first_hits\n"
        "first_hits(scene, [[3, 2, 1]], [[0, 0, 1]])\n"
        "print('left', mi.variant())\n"
        "set_variant, calls = mi.set_variant, []\n"
        "mi.set_variant = lambda *names: (calls.append(names), set_variant(*names))\n"
        "rd.solve(patches, rays=10**5)\n"
        "few = len(calls)\n"
        "rd.solve(rd.subdivide(rd.load_scene('labyrinth'), cells=1), rays=10**5)\n"
        "print('set', few, len(calls))"
    )
    done = python(code)
    assert done.returncode == 0, done.stderr
    return {what: told for what, *told in map(str.split, done.stdout.splitlines())}


def test_a_users_variant_is_left_as_it_was(with_a_variant):
    assert with_a_variant["left"] == ["scalar_rgb"]


def test_a_users_variant_brings_no_warning_of_drjit(with_a_variant):
    """Each change of variant decorates functions of Mitsuba again; above 1000 of them Dr.Jit warns, here an error."""
    assert with_a_variant["warnings"] == ["complete", "True"]


def test_launches_set_no_variant(with_a_variant):
    """It takes 50 ms each time: a user with a variant of his own waited eight times as long for a run."""
    assert with_a_variant["set"] == ["0", "2"]  # a new scene's tree takes one there and one back


def test_other_seeds_and_scenes_compile_no_new_kernel():
    import drjit as dr

    def kernels(scene, seed):
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
            dr.kernel_history_clear()
            rd.solve(rd.subdivide(rd.load_scene(scene), cells=3), "random-walk", quanta=3000, replicates=2, seed=seed)
            return {entry["hash"] for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT}

    first = kernels("room", 1)
    assert kernels("room", 2) == first
    assert len(kernels("labyrinth-0.9", 3) - first) <= 2  # sequences of another length, at most


@pytest.mark.parametrize("turns", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_kernels_stay_within_their_arrays(turns):
    """Dr.Jit's debug mode checks every gather and scatter: open, two-sided, passing and coloured scenes, one replicate and three
    in turn."""
    code = (
        "import sys; sys.path.insert(0, 'tests')\n"
        "import radiosity as rd, drjit as dr\n"
        "from test_lines import stack, scene_of_all_kinds\n"
        "dr.set_flag(dr.JitFlag.Debug, True)\n"
        "scenes = [stack(back) for back in rd.Back] + [scene_of_all_kinds(), rd.load_scene('room'), rd.load_scene('labyrinth')]\n"
        "many = [*((scene, 'breadth-first') for scene in (*scenes, rd.load_scene('cornell-box')))]\n"
        "many += [(scene, 'depth-first') for scene in scenes]\n"
        "for k, (scene, order) in enumerate(many):\n"
        f"    for replicates in [(1, 3)[(k + turn) % 2] for turn in range({turns})]:\n"
        "        rd.solve(rd.subdivide(scene, cells=3), quanta=20_000, replicates=replicates, order=order)\n"
        "print('done')"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=Path(__file__).parents[1], timeout=600
    )
    assert done.stdout.split() == ["done"], done.stderr
    assert "out-of-bounds" not in done.stderr
    assert "out of bounds" not in done.stderr


def test_blocks_of_a_launch_are_what_dr_jit_takes():
    """Powers of two above a packet: for anything else it ends the process."""
    for threads in (1, 2, 3, 16, 128):
        for lanes in (1, 2, 1000, 2**17 + 5, 2**20, 2**28):
            size = blocks.block(lanes, threads, 2**14)
            assert size & (size - 1) == 0
            assert blocks.LEAST <= size <= 2**14
    assert blocks.block(2**20, 2, 32) == 32
    assert blocks.block(136_000, 2, 2**14) == 4096


def test_blocks_are_set_for_a_launch_and_set_back():
    choose("cpu")
    functions = blocks._functions()
    assert functions is not None
    before = functions[0]()
    with blocks.shared(2**17):
        assert functions[0]() == blocks.block(2**17, dr.thread_count(), before) < before
    assert functions[0]() == before
    with pytest.raises(KeyError), blocks.shared(2**17):
        raise KeyError
    assert functions[0]() == before


def test_results_do_not_need_a_size_of_blocks(monkeypatch):
    patches = rd.subdivide(rd.load_scene("room"), cells=2)
    with_blocks = rd.solve(patches, "random-walk", quanta=2**17, replicates=2).state
    monkeypatch.setattr(blocks, "_functions", lambda: None)
    without = rd.solve(patches, "random-walk", quanta=2**17, replicates=2).state
    assert all(np.array_equal(with_blocks[key], without[key]) for key in with_blocks)


def test_exr_files_are_written_and_read_with_one_thread(tmp_path):
    """As on a machine of one core, where Mitsuba's own bitmaps wait for ever."""
    code = (
        "import numpy as np, radiosity as rd\n"
        "from pathlib import Path\n"
        "from radiosity.device.backend import choose\n"
        "choose('cpu')\n"
        "import drjit as dr\n"
        "dr.set_thread_count(1)\n"
        "from radiosity.image.bitmap import write_exr\n"
        "from radiosity.scene.formats.mitsuba.image import read_image\n"
        "from radiosity.scene.parts import ReadOptions\n"
        f"path = Path({str(tmp_path / 'a.exr')!r})\n"
        "write_exr(np.full((300, 400, 3), 0.25), path, {}, ('red', 'green', 'blue'))\n"
        "image = read_image(path, True, ReadOptions())\n"
        "print(image.shape, image.min(), image.max(), dr.thread_count())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout.strip() == "(300, 400, 3) 0.25 0.25 1", done.stderr
