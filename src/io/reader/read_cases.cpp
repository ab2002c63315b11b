// Simulation codes' formats: Exodus, CGNS, VTKHDF, EnSight, OpenFOAM.

#include "src/io/reader/blocks.h"
#include "src/io/reader/file_checks.h"
#include "src/io/reader/status.h"

#include <vtkCGNSReader.h>
#include <vtkDataArraySelection.h>
#include <vtkExodusIIReader.h>
#include <vtkGenericEnSightReader.h>
#include <vtkHDFReader.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkOpenFOAMReader.h>

#include <sys/stat.h>

namespace tetravox::io {

namespace {

/// Asks for all nodal and element variables of all blocks; sets and surfaces stay off.
void select_exodus_arrays(vtkExodusIIReader& reader) {
  for (const int type : {vtkExodusIIReader::NODAL, vtkExodusIIReader::ELEM_BLOCK}) {
    for (int i = 0; i < reader.GetNumberOfObjectArrays(type); ++i)
      reader.SetObjectArrayStatus(type, reader.GetObjectArrayName(type, i), 1);
  }
  for (int i = 0; i < reader.GetNumberOfObjects(vtkExodusIIReader::ELEM_BLOCK); ++i)
    reader.SetObjectStatus(vtkExodusIIReader::ELEM_BLOCK, i, 1);
}

}  // namespace

FileContents read_exodus(const std::string& path, const TimeRequest& time) {
  check_netcdf_length(path);
  const vtkNew<vtkExodusIIReader> reader;
  if (!reader->CanReadFile(path.c_str())) fail_file(path, "not an Exodus file that can be opened");
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  throw_if_vtk_failed(path);
  select_exodus_arrays(*reader);
  FileContents contents;
  update_reader(*reader, path, time, contents);
  append_blocks(reader->GetOutputDataObject(0), contents);
  return contents;
}

FileContents read_cgns(const std::string& path, const TimeRequest& time) {
  const vtkNew<vtkCGNSReader> reader;
  if (!reader->CanReadFile(path.c_str())) fail_file(path, "not a CGNS file that can be opened");
  reader->SetFileName(path.c_str());
  reader->DoublePrecisionMeshOn();
  reader->UpdateInformation();
  throw_if_vtk_failed(path);
  reader->EnableAllBases();
  reader->EnableAllFamilies();
  reader->EnableAllPointArrays();
  reader->EnableAllCellArrays();
  FileContents contents;
  update_reader(*reader, path, time, contents);
  append_blocks(reader->GetOutputDataObject(0), contents);
  return contents;
}

FileContents read_vtkhdf(const std::string& path, const TimeRequest& time) {
  const vtkNew<vtkHDFReader> reader;
  if (!reader->CanReadFile(path.c_str())) fail_file(path, "not a VTKHDF file that can be opened");
  reader->SetFileName(path.c_str());
  FileContents contents;
  update_reader(*reader, path, time, contents);
  append_blocks(reader->GetOutputDataObject(0), contents);
  return contents;
}

FileContents read_ensight(const std::string& path, const TimeRequest& time) {
  const vtkNew<vtkGenericEnSightReader> reader;
  reader->SetCaseFileName(path.c_str());
  reader->ReadAllVariablesOn();
  FileContents contents;
  update_reader(*reader, path, time, contents);
  check_ensight_files(path, contents.times.empty() ? 0.0 : contents.times[contents.time_index]);
  append_blocks(reader->GetOutputDataObject(0), contents);
  return contents;
}

FileContents read_openfoam(const std::string& path, const TimeRequest& time) {
  const vtkNew<vtkOpenFOAMReader> reader;
  struct stat status {};
  const bool is_directory = stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode);
  reader->SetFileName((is_directory ? path + "/system/controlDict" : path).c_str());
  reader->CreateCellToPointOff();  // Cell values are drawn as they stand, not averaged to points.
  reader->DecomposePolyhedraOff();
  reader->UpdateInformation();
  throw_if_vtk_failed(path);
  reader->DisableAllPatchArrays();
  reader->SetPatchArrayStatus("internalMesh", 1);
  reader->EnableAllCellArrays();
  reader->EnableAllPointArrays();
  reader->DisableAllLagrangianArrays();
  FileContents contents;
  update_reader(*reader, path, time, contents);
  append_blocks(reader->GetOutputDataObject(0), contents);
  return contents;
}

}  // namespace tetravox::io
