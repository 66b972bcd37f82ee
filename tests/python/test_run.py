"""run() and check(): the result is the file of the program; warnings, errors, Ctrl-C, threads.

Truth: `cloudbow run` itself.
"""
import os
import threading
import tomllib

import cloudbow as cb
import numpy as np
import pytest
import xarray as xr
from conftest import assert_same, assert_same_results

from cloudbow import _toml


def write_scene(folder, scene):
    path = folder / "scene.toml"
    path.write_text(_toml.document(scene))
    return path


def test_result_is_the_file_of_the_program(layers, program, tmp_path):
    path = write_scene(tmp_path, layers)
    program("run", path, "-o", tmp_path / "a.h5", "--quiet")
    ds = cb.run(path)
    with xr.open_dataset(tmp_path / "a.h5", engine="h5netcdf") as file:
        assert_same(ds, file, apart={"history"})
        assert ds.attrs["scene"] == path.read_text()
    assert_same_results(ds, cb.open_result(tmp_path / "a.h5"), apart={"history"})
    assert "cloudbow.run(" in ds.attrs["history"]
    assert {"/solver", "/ledger", "/profile"} <= set(ds.cloudbow.groups)


def test_cloud_result_is_the_file_of_the_program(cloud, program, tmp_path):
    cb.write_vdb(tmp_path / "cloud.vdb", cloud["cloud"]["file"])
    cloud["cloud"]["file"] = "cloud.vdb"
    path = write_scene(tmp_path, cloud)
    program("run", path, "-o", tmp_path / "a.h5", "--quiet", "--compare")
    assert_same_results(cb.run(path, compare=True), cb.open_result(tmp_path / "a.h5"), apart={"history"})


def test_clear_sky_is_a_group(cloud, layers, program, tmp_path):
    cloud["layer"] = layers["layer"][:1]
    ds = cb.run(cloud, clear_sky=True)
    assert float(ds.cloudbow.groups["/clear_sky"].upwelling_flux.isel(z_edge=-1).mean()) < float(ds.upwelling_flux.isel(z_edge=-1).mean())
    with pytest.raises(cb.InputError, match="clear-sky"):
        cb.run(layers, clear_sky=True)


def test_output_is_kept_and_replaced(layers, tmp_path):
    for _ in range(2):
        ds = cb.run(layers, output=tmp_path / "kept.h5")
    assert_same_results(ds, cb.open_result(tmp_path / "kept.h5"), apart=set())
    assert [p.name for p in tmp_path.iterdir()] == ["kept.h5"]


def test_output_over_an_input_is_refused(layers, tmp_path):
    path = write_scene(tmp_path, layers)
    with pytest.raises(cb.InputError, match="scene.toml"):
        cb.run(path, output=path)
    assert tomllib.loads(path.read_text()) == layers


def test_settings_as_those_of_the_program(layers, program, tmp_path):
    path = write_scene(tmp_path, layers)
    program("run", path, "-o", tmp_path / "a.h5", "--quiet", "--set", "sun.zenith_deg=61", "--set", "layer.1.optical_depth=0.3")
    ds = cb.run(path, set={"sun.zenith_deg": 61, "layer.1.optical_depth": np.float64(0.3)})
    assert_same_results(ds, cb.open_result(tmp_path / "a.h5"))
    assert_same_results(ds, cb.run(layers, set={"sun.zenith_deg": 61.0, "layer.1.optical_depth": 0.3}))


def test_threads_do_not_change_bits(cloud):
    one, two = cb.run(cloud, threads=1), cb.run(cloud, threads=np.int64(2))
    assert one.upwelling_flux.values.tobytes() == two.upwelling_flux.values.tobytes()


def test_progress_counts_sweeps(cloud):
    states = []
    ds = cb.run(cloud, progress=states.append)
    sweeps = [state.sweep for state in states if state.phase == "sweep"]
    assert sweeps == sorted(sweeps) and sweeps[-1] == int(ds.cloudbow.groups["/solver"].sweeps if "sweeps" in ds.cloudbow.groups["/solver"]
                                                          else ds.cloudbow.groups["/solver"].attrs["sweeps"])
    assert all(0 <= state.fraction <= 1 for state in states)


def test_an_exception_of_progress_ends_the_run(cloud):
    class Enough(Exception):
        pass
    calls = []

    def stop(state):
        calls.append(state)
        raise Enough
    with pytest.raises(Enough):
        cb.run(cloud, progress=stop)
    assert len(calls) == 1


def test_calls_within_progress(cloud, layers):
    inner = []

    def look(state):
        if not inner:
            inner.append(cb.run(layers))
    cb.run(cloud, progress=look)
    assert_same_results(inner[0], cb.run(layers))


def test_guesses_are_notes(cloud):
    """They stand at the line of the user, and name the key."""
    cloud.update(thermal={"wavelength_um": 3.9}, atmosphere={"standard": "us-1976"}, surface={"albedo": 0.1, "temperature_k": 290.0})
    with pytest.warns(cb.Note, match="^scene: sun.irradiance_w_m2: ") as notes:
        cb.run(cloud)
    assert [note.filename for note in notes] == [__file__]
    with pytest.warns(cb.Note, match="^scene: sun.irradiance_w_m2: ") as notes:
        cb.check(cloud)
    assert [note.filename for note in notes] == [__file__]


def test_not_converged_is_a_warning(cloud):
    with pytest.warns(cb.NotConverged, match="not converged.* after 1 sweeps"):
        ds = cb.run(cloud, set={"solver.max_sweeps": 1, "solver.tolerance": 1e-8})
    assert (ds.upwelling_flux > 0).any()


@pytest.mark.parametrize("key, value, message", [
    ("sun.zenith_deg", 100, "sun.zenith_deg"), ("sun.zenit_deg", 10, "sun.zenit_deg"), ("surface.type", "snow", "surface.type"),
    ("layer.7.optical_depth", 1, "layer.7"), ("cloud.file", "not_there.vdb", "cloud.file"), ("sun.zenith_deg", 1j, "sun.zenith_deg"),
    ("sun.zenith_deg", None, "sun.zenith_deg"), ("sun.zenith_deg.x", 1, "sun.zenith_deg.x"), ("layer.0.optical_depth", np.ones((2, 2)), "layer.0.optical_depth")])
def test_wrong_keys_are_named(layers, tmp_path, key, value, message):
    with pytest.raises(cb.InputError, match=message):
        cb.run(layers, set={key: value})
    with pytest.raises(ValueError, match=message):
        cb.run(write_scene(tmp_path, layers), set={key: value})


def test_messages_do_not_name_files_of_the_package(layers):
    with pytest.raises(cb.InputError) as error:
        cb.run(layers, set={"sun.zenith_deg": 100})
    assert str(error.value).startswith("scene: sun.zenith_deg: ")
    with pytest.raises(cb.InputError, match="^scene: "):
        cb.run({"title": "empty"})


def test_wrong_arguments(layers):
    for arguments in ({"threads": 0}, {"threads": 1.5}, {"threads": True}, {"progress": 3}):
        with pytest.raises(cb.InputError, match=next(iter(arguments))):
            cb.run(layers, **arguments)
    with pytest.raises(cb.InputError, match="scene"):
        cb.run(7)


def test_check_is_the_dry_run(cloud, layers, program, tmp_path):
    answer = cb.check(cloud)
    assert (answer.columns, answer.levels) == ((8, 6), 5)
    assert answer.memory_bytes > 0 and answer.seconds > 0 and "optical depth" in str(answer)
    path = write_scene(tmp_path, layers)
    printed = program("run", path, "--dry-run").stdout
    assert printed.splitlines()[:3] == str(cb.check(path)).splitlines()[:3]
    with pytest.raises(cb.InputError, match="sun.zenith_deg"):
        cb.check(layers, set={"sun.zenith_deg": -1})


def test_two_threads_run_two_scenes_at_once(cloud, layers):
    """Each waits in its progress for the other: neither would end if one held the other up."""
    alone = [cb.run(cloud, threads=1), cb.run(cloud, set={"sun.zenith_deg": 50}, threads=1)]
    meeting = threading.Barrier(2, timeout=120)
    found = [None, None]

    def work(n, settings):
        met = []

        def meet(state):
            if state.phase == "sweep" and not met:
                met.append(meeting.wait())
        found[n] = cb.run(cloud, set=settings, threads=1, progress=meet)
    threads = [threading.Thread(target=work, args=(n, settings)) for n, settings in enumerate([{}, {"sun.zenith_deg": 50}])]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for one, two in zip(found, alone):
        assert_same_results(one, two)


def test_many_threads_with_h5py(cloud, tmp_path):
    """HDF5 is one library for h5py and the package; both work at once, with children forked meanwhile."""
    import h5py
    failures = []
    stop = threading.Event()

    def noting(work):
        try:
            work()
        except Exception as error:  # noqa: BLE001
            failures.append(error)

    def write():
        n = 0
        while not stop.is_set():
            n += 1
            with h5py.File(tmp_path / "other.h5", "w") as file:
                file["a"] = np.full(1000, n)
            with h5py.File(tmp_path / "other.h5") as file:
                assert (file["a"][:] == n).all()

    def solve():
        for _ in range(5):
            cb.run(cloud, threads=1)
    writer = threading.Thread(target=noting, args=(write,))
    writer.start()
    solvers = [threading.Thread(target=noting, args=(solve,)) for _ in range(3)]
    for thread in solvers:
        thread.start()
    for thread in solvers:
        thread.join()
    stop.set()
    writer.join()
    assert not failures


def resident_megabytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") / 1e6


def test_many_runs_keep_their_memory(layers, cloud):
    """Issue: 100 small runs grow by less than 5 MB. Warmed up, so that caches and pools are there."""
    for scene in (layers, cloud):
        for _ in range(10):
            cb.run(scene, threads=1)
        before = resident_megabytes()
        for _ in range(100):
            cb.run(scene, threads=1)
        assert resident_megabytes() - before < 5


def test_host_keeps_its_state(layers):
    """No signal handler, number of threads or working directory changes; no file is left in the temporary folder."""
    import signal
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGPIPE, signal.SIGXFSZ, signal.SIGCHLD)], os.getcwd()
    cb.run(layers, threads=1)
    assert before == ([signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGPIPE, signal.SIGXFSZ, signal.SIGCHLD)], os.getcwd())
