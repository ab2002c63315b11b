"""Draws a scene with one of VTK's mappers, frame by frame as told on standard input.

    vtk_peer.py SCENE.json bunyk|pt|fixed|gpu|fixed:shaded|gpu:shaded WIDTH HEIGHT

Answers each line with one line of JSON:
    frame         draws the scene                     {"seconds": .., "peak_rss": ..}
    image F.npy   writes the picture last drawn       {"image": "F.npy"}
The first answer, without a question: {"vtk": "9.1.0", "read": seconds}. Needs a display. The end of input ends it.
"""
import json
import os
import resource
import sys
import time

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

MAPPERS = {
    "bunyk": vtk.vtkUnstructuredGridVolumeRayCastMapper,  # Bunyk, Kaufman, Silva 1997
    "pt": vtk.vtkProjectedTetrahedraMapper,  # Shirley and Tuchman 1990, on OpenGL
    "fixed": vtk.vtkFixedPointVolumeRayCastMapper,  # images, samples along rays, all cores
    "gpu": vtk.vtkGPUVolumeRayCastMapper,  # images, samples along rays, on OpenGL
}
READERS = {".vtu": vtk.vtkXMLUnstructuredGridReader, ".vti": vtk.vtkXMLImageDataReader}


def read_dataset(path, array):
    reader = READERS[os.path.splitext(path)[1]]()
    reader.SetFileName(path)
    reader.Update()
    dataset = reader.GetOutput()
    if array:
        dataset.GetPointData().SetActiveScalars(array)
    return dataset


def make_property(function, is_shaded):
    """Mappers for images take opacities for the unit distance, as scenes mean them. Those for meshes take the opacity
    function's value as an extinction where the unit distance is 1."""
    unit_distance = function.get("unit_distance")
    absorption = "opacity" if unit_distance else "extinction"
    color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    last = None
    for point in function["points"]:
        value = point["value"]
        if last is not None and value <= last:
            value = float(np.nextafter(np.float32(last), np.float32(np.inf)))  # a step: VTK keeps one point a value
        color.AddRGBPoint(value, *point["color"])
        opacity.AddPoint(value, point[absorption])
        last = value
    volume_property = vtk.vtkVolumeProperty()
    volume_property.SetColor(color)
    volume_property.SetScalarOpacity(opacity)
    volume_property.SetScalarOpacityUnitDistance(unit_distance or 1.0)
    volume_property.SetInterpolationTypeToLinear()
    volume_property.SetShade(is_shaded)
    volume_property.SetAmbient(0.3)
    volume_property.SetDiffuse(0.7)
    volume_property.SetSpecular(0.3)
    volume_property.SetSpecularPower(32)
    return volume_property


def make_mapper(name, dataset):
    mapper = MAPPERS[name]()
    mapper.SetInputData(dataset)
    if name != "pt":  # one ray a pixel in every frame
        mapper.SetAutoAdjustSampleDistances(False)
        mapper.SetImageSampleDistance(1.0)
    if dataset.IsA("vtkImageData"):  # one sample a voxel
        mapper.SetSampleDistance(sum(dataset.GetSpacing()) / 3)
    return mapper


def make_window(volume, scene, width, height):
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.AddVolume(volume)
    window = vtk.vtkRenderWindow()
    window.OffScreenRenderingOn()
    window.SetMultiSamples(0)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    camera, wanted = renderer.GetActiveCamera(), scene["camera"]
    camera.SetPosition(wanted["position"])
    camera.SetFocalPoint(wanted["focal_point"])
    camera.SetViewUp(wanted["view_up"])
    camera.SetViewAngle(wanted.get("view_angle", 30))
    if "parallel_scale" in wanted:
        camera.ParallelProjectionOn()
        camera.SetParallelScale(wanted["parallel_scale"])
    renderer.ResetCameraClippingRange()
    return window, camera


class Peer:
    def __init__(self, scene_path, mapper, width, height):
        with open(scene_path) as file:
            scene = json.load(file)
        start = time.perf_counter()
        path = os.path.join(os.path.dirname(scene_path), scene["data"]["file"])
        dataset = read_dataset(path, scene["data"].get("array"))
        self.read_seconds = time.perf_counter() - start
        volume = vtk.vtkVolume()
        name, _, shaded = mapper.partition(":")
        volume.SetMapper(make_mapper(name, dataset))
        volume.SetProperty(make_property(scene["transfer_function"], bool(shaded)))
        self.size = width, height
        self.window, self.camera = make_window(volume, scene, width, height)
        self.picture = None

    def draw(self):
        """Seconds for one frame, until its pixels are in memory."""
        width, height = self.size
        pixels = vtk.vtkUnsignedCharArray()
        start = time.perf_counter()
        self.camera.Modified()  # otherwise an unchanged picture is kept
        self.window.Render()
        self.window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, pixels)
        seconds = time.perf_counter() - start
        self.picture = vtk_to_numpy(pixels).reshape(height, width, 4)[::-1]
        return seconds


def main():
    scene_path, mapper, width, height = sys.argv[1:5]
    peer = Peer(scene_path, mapper, int(width), int(height))
    answer({"vtk": vtk.vtkVersion().GetVTKVersion(), "read": peer.read_seconds})
    for line in sys.stdin:
        command, _, argument = line.strip().partition(" ")
        if command == "frame":
            seconds = peer.draw()
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
            answer({"seconds": seconds, "peak_rss": peak})
        elif command == "image":
            np.save(argument, peer.picture.astype(np.float32) / 255)
            answer({"image": argument})
        else:
            answer({"error": f"unknown command '{command}'"})


def answer(value):
    print(json.dumps(value), flush=True)


if __name__ == "__main__":
    main()
