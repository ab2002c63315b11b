#include "src/io/reader/blocks.h"

#include "src/io/formats.h"
#include "src/io/reader/status.h"
#include "src/io/time_steps.h"

#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkCompositeDataIterator.h>
#include <vtkCompositeDataSet.h>
#include <vtkInformation.h>
#include <vtkNew.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>

namespace tetravox::io {

namespace {

/// Forwards VTK's progress in steps of a hundredth; the last tenth is left for handing the arrays over.
void forward_progress(vtkObject* caller, unsigned long, void*, void*) {
  static double last = 0.0;
  const double fraction = 0.9 * static_cast<vtkAlgorithm*>(caller)->GetProgress();
  if (fraction < last + 0.01 || fraction > 1.0) return;
  last = fraction;
  send_progress(fraction);
}

std::vector<double> reader_times(vtkAlgorithm& reader) {
  vtkInformation* information = reader.GetOutputInformation(0);
  if (!information || !information->Has(vtkStreamingDemandDrivenPipeline::TIME_STEPS())) return {};
  const double* first = information->Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
  const int count = information->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
  return {first, first + count};
}

}  // namespace

void fail_file(const std::string& path, const std::string& what) {
  throw Error(ErrorCode::kBadFile, "'" + path + "': " + what + "; the file is damaged or not what its ending says");
}

void update_reader(vtkAlgorithm& reader, const std::string& path, const TimeRequest& time, FileContents& contents) {
  vtkNew<vtkCallbackCommand> progress;
  progress->SetCallback(forward_progress);
  reader.AddObserver(vtkCommand::ProgressEvent, progress);
  reader.UpdateInformation();
  throw_if_vtk_failed(path);
  contents.times = reader_times(reader);
  contents.time_index = pick_time(contents.times, time, path);
  if (contents.times.empty())
    reader.Update();
  else
    reader.UpdateTimeStep(contents.times[contents.time_index]);
  throw_if_vtk_failed(path);
}

void append_blocks(vtkDataObject* data, FileContents& contents) {
  const auto append = [&](vtkDataObject* object) {
    if (auto* set = vtkDataSet::SafeDownCast(object)) contents.blocks.emplace_back(set);
  };
  auto* composite = vtkCompositeDataSet::SafeDownCast(data);
  if (!composite) return append(data);
  const auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    append(iterator->GetCurrentDataObject());
}

FileContents read_file(const std::string& path, const std::string& grid_file, const TimeRequest& time) {
  const Format format = detect_format(path, !grid_file.empty());
  const auto read = [&]() -> FileContents {
    switch (format) {
      case Format::kVtu:
      case Format::kVts:
      case Format::kVtr:
      case Format::kVti:
        return read_xml(path, time);
      case Format::kParallelXml:
      case Format::kParallelGrid:
      case Format::kMultiBlock:
      case Format::kPvd:
        return read_collection(path, time);
      case Format::kLegacyVtk:
        return read_legacy(path);
      case Format::kVtkHdf:
        return read_vtkhdf(path, time);
      case Format::kExodus:
        return read_exodus(path, time);
      case Format::kCgns:
        return read_cgns(path, time);
      case Format::kEnSight:
        return read_ensight(path, time);
      case Format::kOpenFoam:
        return read_openfoam(path, time);
      case Format::kUcd:
        return read_ucd(path);
      case Format::kPlot3d:
        return read_plot3d(path, grid_file);
      case Format::kNrrd:
        return read_nrrd(path, time);
      case Format::kMetaImage:
        return read_meta_image(path, time);
      case Format::kNifti:
        return read_nifti(path, time);
      case Format::kSlc:
        return read_slc(path);
      case Format::kDicom:
        return read_dicom(path);
      case Format::kTiff:
        return read_tiff(path);
      case Format::kMrc:
        return read_mrc(path);
      case Format::kRaw:  // Read without this process; no collection names one.
      case Format::kHierarchy:
      case Format::kSurface:
        break;
    }
    return {};  // A part of a collection that is not drawn.
  };
  FileContents contents = read();
  contents.format = format_name(format);
  if (contents.times.empty()) contents.time_index = pick_time({}, time, path);
  return contents;
}

}  // namespace tetravox::io
