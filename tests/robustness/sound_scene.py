"""A scene that runs, over cloud.vdb beside it: what the checks here spoil or disturb. Ends in the table [solver]."""

SCENE = """\
title = "a scene that runs"
[cloud]
file = "cloud.vdb"
grid = "density"
quantity = "extinction"
scale = 1.0
single_scattering_albedo = 0.99
phase_function = "droplets"
[phase_function.droplets]
type = "henyey-greenstein"
asymmetry_parameter = 0.85
[sun]
zenith_deg = 60.0
azimuth_deg = 0.0
[surface]
type = "lambertian"
albedo = 0.05
[solver]
accuracy = "draft"
"""
