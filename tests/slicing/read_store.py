"""Reads a build through layers.h5 and writes all arrays raw: read_store.py BUILD OUT."""

import sys

import h5py

build, out = sys.argv[1:]
with h5py.File(build + "/layers.h5", "r") as master, open(out, "wb") as raw:
    assert master.attrs["format"].decode() == "lamella-layers"
    assert master.attrs["version"] == 1
    assert master.attrs["length_unit"].decode() == "mm"
    assert [name.decode() for name in master["material_names"]][0] == "PA 12"
    assert len(master["solid_paths"]) == 3
    layers = sorted(name for name in master if name.startswith("layer_"))
    for k, name in enumerate(layers):
        layer = master[name]
        assert layer.attrs["index"] == k
        assert layer.attrs["z_bottom"] < layer.attrs["z_sample"] < layer.attrs["z_top"]
        for rows in (layer["raster"], layer["hatch"]):
            assert rows["x_begin"].attrs["unit"].decode() == "mm"
            for array, kind in zip(("row_start", "x_begin", "x_end", "material", "solid"), "uffuu"):
                assert rows[array].dtype.kind == kind
                raw.write(rows[array][:].tobytes())
        assert layer["hatch"].attrs["first_row"] == -7 - k
