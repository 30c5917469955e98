"""Opens a result file with h5py: values, units, named dimensions, text."""

import h5py
from expected import arguments, check, text

path, datasets, case = arguments()
with h5py.File(path, "r") as file:
    check("/", "case_toml", text(file.attrs["case_toml"]), case)
    check("/", "run_status", text(file.attrs["run_status"]), "complete")
    check("/", "schema_version", int(file.attrs["schema_version"]), 1)
    check("body", "flag_meanings", text(file["body"].attrs["flag_meanings"]), "crank coupler follower")
    for dataset in datasets:
        found = file[dataset.name]
        check(dataset.name, "shape", found.shape, dataset.shape)
        check(dataset.name, "units", text(found.attrs["units"]), dataset.unit)
        if not found.is_scale:
            names = tuple(dimension[0].name.lstrip("/") for dimension in found.dims)
            check(dataset.name, "dimensions", names, dataset.dimensions)
        dataset.check_values(found[()].reshape(-1))
    known = {dataset.name for dataset in datasets}
    scales = {"time", "body", "joint", "clearance", "drive", "event", "contact", "peak", "revolution"}
    check("/", "set of datasets", set(file), known | scales)
    for name in scales - {"time"}:
        check(name, "values", list(file[name][()]), list(range(len(file[name]))))
    kinds = {file[name].dtype.str for name in file}
    check("/", "set of types", kinds, {"<f8", "<i4", "|i1"})
