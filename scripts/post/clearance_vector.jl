# Draws the clearance vector of a joint with Julia: RESULT.h5 JOINT PICTURE.
# Shown, not tested: needs the packages HDF5 and Plots. Julia sees the dimensions reversed, so that
# a column here is a row of the file.

using HDF5, Plots

path, joint, picture = ARGS
h5open(path) do run
    items = split(read_attribute(run["clearance"], "flag_meanings"))
    k = findfirst(==(joint), items)
    x, y = run["clearance_x"][k, :], run["clearance_y"][k, :]
    plot(1e3x, 1e3y; aspect_ratio = :equal, legend = false, xlabel = "x (mm)", ylabel = "y (mm)",
         title = "Journal centre in joint $joint")
    savefig(picture)
    println("$joint: largest eccentricity $(maximum(run["eccentricity"][k, :])) m")
end
