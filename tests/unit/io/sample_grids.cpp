#include "tests/unit/io/sample_grids.h"

#include "tests/unit/io/hdf5_writing.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <sstream>

namespace tetravox::test {

namespace {

namespace fs = std::filesystem;

template <class T>
std::string values_of_type(bool is_big_endian) {
  std::string out;
  for (std::size_t k = 0; k < 5; ++k)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t i = 0; i < 4; ++i) append_number(out, static_cast<T>(sample_value(i, j, k)), is_big_endian);
  return out;
}

std::string values_text() {
  std::ostringstream out;
  for (std::size_t n = 0; n < kSamplePoints; ++n) out << n + 1 << (n % 12 == 11 ? '\n' : ' ');
  return out.str();
}

const char* const kXmlHead = "version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";
const char* const kXmlFrame = "Origin=\"10 20 30\" Spacing=\"0.5 1 2\"";

/// VTI text of layers k0 to k1.
std::string vti_text(std::size_t k0, std::size_t k1) {
  std::ostringstream out, values;
  for (std::size_t n = 12 * k0; n < 12 * (k1 + 1); ++n) values << n + 1 << ' ';
  const std::string extent = "0 3 0 2 " + std::to_string(k0) + ' ' + std::to_string(k1);
  out << "<VTKFile type=\"ImageData\" " << kXmlHead << "<ImageData WholeExtent=\"" << extent << "\" " << kXmlFrame
      << ">\n<Piece Extent=\"" << extent << "\"><PointData><DataArray type=\"UInt8\" Name=\"S\" format=\"ascii\">\n"
      << values.str() << "</DataArray></PointData></Piece></ImageData></VTKFile>\n";
  return out.str();
}

void write_vti(const fs::path& directory) { write_text(directory / "grid.vti", vti_text(0, 4)); }

void write_vti_appended(const fs::path& directory) {
  std::string data;
  append_number(data, std::uint64_t{kSamplePoints * 4});
  data += sample_bytes(ScalarType::kFloat32);
  write_text(directory / "grid.vti",
             std::string("<VTKFile type=\"ImageData\" ") + kXmlHead + "<ImageData WholeExtent=\"0 3 0 2 0 4\" " +
                 kXmlFrame +
                 ">\n<Piece Extent=\"0 3 0 2 0 4\"><PointData><DataArray type=\"Float32\" Name=\"S\" "
                 "format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>\n<AppendedData "
                 "encoding=\"raw\">\n_" +
                 data + "\n</AppendedData></VTKFile>\n");
}

void write_pvti(const fs::path& directory) {
  write_text(directory / "low.vti", vti_text(0, 2));
  write_text(directory / "high.vti", vti_text(2, 4));
  write_text(directory / "grid.pvti",
             std::string("<VTKFile type=\"PImageData\" ") + kXmlHead +
                 "<PImageData WholeExtent=\"0 3 0 2 0 4\" GhostLevel=\"0\" " + kXmlFrame +
                 "><PPointData><PDataArray type=\"UInt8\" Name=\"S\"/></PPointData>\n"
                 "<Piece Extent=\"0 3 0 2 0 2\" Source=\"low.vti\"/>\n<Piece Extent=\"0 3 0 2 2 4\" "
                 "Source=\"high.vti\"/>\n</PImageData></VTKFile>\n");
}

void write_vtm(const fs::path& directory) {
  write_text(directory / "part.vti", vti_text(0, 4));
  write_text(directory / "grid.vtm",
             "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\">\n<vtkMultiBlockDataSet>"
             "<DataSet index=\"0\" file=\"part.vti\"/></vtkMultiBlockDataSet></VTKFile>\n");
}

/// VTR text of layers k0 to k1.
std::string vtr_text(std::size_t k0, std::size_t k1) {
  std::ostringstream out, values, z;
  for (std::size_t n = 12 * k0; n < 12 * (k1 + 1); ++n) values << n + 1 << ' ';
  for (std::size_t k = k0; k <= k1; ++k) z << 30 + 2 * k << ' ';
  const auto axis = [](const std::string& text) {
    return "<DataArray type=\"Float64\" format=\"ascii\">" + text + "</DataArray>\n";
  };
  const std::string extent = "0 3 0 2 " + std::to_string(k0) + ' ' + std::to_string(k1);
  out << "<VTKFile type=\"RectilinearGrid\" " << kXmlHead << "<RectilinearGrid WholeExtent=\"" << extent
      << "\">\n<Piece Extent=\"" << extent << "\"><PointData><DataArray type=\"UInt8\" Name=\"S\" format=\"ascii\">\n"
      << values.str() << "</DataArray></PointData>\n<Coordinates>" << axis("10 10.5 11 11.5") << axis("20 21 22")
      << axis(z.str()) << "</Coordinates></Piece></RectilinearGrid></VTKFile>\n";
  return out.str();
}

void write_vtr(const fs::path& directory) { write_text(directory / "grid.vtr", vtr_text(0, 4)); }

void write_pvtr(const fs::path& directory) {
  write_text(directory / "low.vtr", vtr_text(0, 2));
  write_text(directory / "high.vtr", vtr_text(2, 4));
  write_text(directory / "grid.pvtr",
             std::string("<VTKFile type=\"PRectilinearGrid\" ") + kXmlHead +
                 "<PRectilinearGrid WholeExtent=\"0 3 0 2 0 4\" GhostLevel=\"0\">\n"
                 "<Piece Extent=\"0 3 0 2 0 2\" Source=\"low.vtr\"/>\n<Piece Extent=\"0 3 0 2 2 4\" "
                 "Source=\"high.vtr\"/>\n</PRectilinearGrid></VTKFile>\n");
}

void write_legacy(const fs::path& directory, bool is_binary) {
  write_text(directory / "grid.vtk",
             std::string("# vtk DataFile Version 3.0\na grid\n") + (is_binary ? "BINARY" : "ASCII") +
                 "\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 3 5\nSPACING 0.5 1 2\nORIGIN 10 20 30\nPOINT_DATA 60\n"
                 "SCALARS S " +
                 (is_binary ? "short" : "unsigned_char") + " 1\nLOOKUP_TABLE default\n" +
                 (is_binary ? sample_bytes(ScalarType::kInt16, true) + "\n" : values_text()));
}

void write_legacy_rectilinear(const fs::path& directory) {
  write_text(directory / "grid.vtk",
             "# vtk DataFile Version 3.0\na grid\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 4 3 5\n"
             "X_COORDINATES 4 float\n10 10.5 11 11.5\nY_COORDINATES 3 float\n20 21 22\n"
             "Z_COORDINATES 5 float\n30 32 34 36 38\nPOINT_DATA 60\nSCALARS S unsigned_char 1\n"
             "LOOKUP_TABLE default\n" +
                 values_text());
}

std::string nrrd_header(const std::string& encoding, const std::string& type, const std::string& more = {}) {
  return "NRRD0005\n# a grid\ntype: " + type +
         "\ndimension: 3\nsizes: 4 3 5\nspace: left-posterior-superior\nspace directions: (0.5,0,0) (0,1,0) (0,0,2)\n"
         "space origin: (10,20,30)\nencoding: " +
         encoding + "\n" + more + "\n";
}

void write_meta(const fs::path& directory, const std::string& name, const std::string& more, const std::string& data,
                const std::string& file) {
  const std::string header =
      "ObjectType = Image\nNDims = 3\nDimSize = 4 3 5\nElementSpacing = 0.5 1 2\nOffset = 10 20 30\n" + more +
      "ElementDataFile = " + file + "\n";
  if (file == "LOCAL") return write_text(directory / name, header + data);
  write_text(directory / name, header);
  write_text(directory / file, data);
}

std::string nifti_file(bool is_single) {
  std::string header = nifti_header(4, 16);
  if (!is_single) {
    set_number(header, 108, 0.0f);
    header.replace(344, 4, std::string("ni1\0", 4));
    header.resize(348);
  }
  return header;
}

void write_nifti2(const fs::path& directory) {
  std::string header(544, '\0');
  set_number(header, 0, std::int32_t{540});
  header.replace(4, 8, std::string("n+2\0\r\n\032\n", 8));
  set_number(header, 12, std::int16_t{16});
  set_number(header, 14, std::int16_t{32});
  const std::int64_t sizes[] = {3, 4, 3, 5};
  for (std::size_t i = 0; i < 4; ++i) set_number(header, 16 + 8 * i, sizes[i]);
  set_number(header, 168, std::int64_t{544});
  set_number(header, 348, std::int32_t{1});
  const double rows[3][4] = {{0.5, 0, 0, 10}, {0, 1, 0, 20}, {0, 0, 2, 30}};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      set_number(header, 400 + 32 * row + 8 * column, rows[row][column]);
  write_text(directory / "grid.nii", header + sample_bytes(ScalarType::kFloat32));
}

void write_slc(const fs::path& directory, bool is_packed) {
  std::string out = "11111\n4 3 5 8\n0.5 1 2\n1 1 0 " + std::to_string(is_packed ? 1 : 0) + "\n2 2 X";
  out += std::string(12, '\7');
  const std::string bytes = sample_bytes(ScalarType::kUint8);
  for (std::size_t k = 0; k < 5; ++k) {
    const std::string slice = bytes.substr(12 * k, 12);
    if (!is_packed) {
      out += slice;
      continue;
    }
    // Seven bytes as they are, four single runs, one more as it is, the end.
    std::string packed = "\x87" + slice.substr(0, 7);
    for (std::size_t i = 7; i < 11; ++i) packed += std::string("\1") + slice[i];
    packed += "\x81" + slice.substr(11) + std::string(1, '\0');
    out += std::to_string(packed.size()) + " X" + packed;
  }
  write_text(directory / "grid.slc", out);
}

void write_dicom(const fs::path& directory) {
  // Neither the names nor the order of files tell where slices lie.
  const char* const names[] = {"c.dcm", "a.dcm", "e.dcm", "b.dcm", "d.dcm"};
  for (std::size_t k = 0; k < 5; ++k) write_text(directory / names[k], dicom_slice(k));
  write_text(directory / "readme.txt", "five slices");
}

/// A ZIP archive of stored files.
void write_dicom_zip(const fs::path& directory) {
  std::string out, entries;
  std::uint16_t count = 0;
  const auto header = [](const std::string& name, const std::string& data) {
    std::string head;
    for (const int number : {20, 0, 0, 0, 0}) append_number(head, static_cast<std::uint16_t>(number));
    append_number(head,
                  static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(data.data()), data.size())));
    append_number(head, static_cast<std::uint32_t>(data.size()));
    append_number(head, static_cast<std::uint32_t>(data.size()));
    append_number(head, static_cast<std::uint16_t>(name.size()));
    return head;
  };
  for (std::size_t k = 0; k < 5; ++k, ++count) {
    const std::string name = "slices/" + std::to_string(k), data = dicom_slice(k);
    entries += std::string("PK\1\2\24\0", 6) + header(name, data) + std::string(12, '\0');
    append_number(entries, static_cast<std::uint32_t>(out.size()));
    entries += name;
    out += "PK\3\4" + header(name, data) + std::string(2, '\0') + name + data;
  }
  const std::size_t begin = out.size();
  out += entries + std::string("PK\5\6\0\0\0\0", 8);
  append_number(out, count);
  append_number(out, count);
  append_number(out, static_cast<std::uint32_t>(entries.size()));
  append_number(out, static_cast<std::uint32_t>(begin));
  write_text(directory / "grid.zip", out + std::string(2, '\0'));
}

void write_dicom_frames(const fs::path& directory) {
  std::string file = dicom_slice(0, dicom_element(0x0028, 0x0008, "IS", "5 "));
  const std::size_t pixels = file.size() - 24 - 12;
  file.resize(pixels);
  file += dicom_element(0x7FE0, 0x0010, "OW", sample_bytes(ScalarType::kUint16));
  write_text(directory / "grid.dcm", file);
}

/// Rows of slice k from the top, which is the last row of the grid.
std::string tiff_page(std::size_t k) {
  std::string out;
  for (std::size_t j = 3; j-- > 0;)
    for (std::size_t i = 0; i < 4; ++i) out += static_cast<char>(sample_value(i, j, k));
  return out;
}

void write_tiff_pages(const fs::path& directory) {
  std::vector<std::string> pages;
  for (std::size_t k = 0; k < 5; ++k) pages.push_back(tiff_page(k));
  write_text(directory / "grid.tif", tiff_file(pages, 4, 3));
}

void write_tiff_directory(const fs::path& directory) {
  for (std::size_t k = 0; k < 5; ++k)  // slice8 ... slice12: as text they would be in another order.
    write_text(directory / ("slice" + std::to_string(8 + k) + ".tif"), tiff_file({tiff_page(k)}, 4, 3));
}

void write_vtkhdf(const fs::path& directory) {
  fs::create_directories(directory);
  const hid_t file = H5Fcreate((directory / "grid.vtkhdf").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  write_vtkhdf_type(group, "ImageData");
  const std::int64_t extent[] = {0, 3, 0, 2, 0, 4};
  const double origin[] = {10, 20, 30}, spacing[] = {0.5, 1, 2}, direction[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  write_hdf5_attribute(group, "WholeExtent", H5T_NATIVE_INT64, 6, extent);
  write_hdf5_attribute(group, "Origin", H5T_NATIVE_DOUBLE, 3, origin);
  write_hdf5_attribute(group, "Spacing", H5T_NATIVE_DOUBLE, 3, spacing);
  write_hdf5_attribute(group, "Direction", H5T_NATIVE_DOUBLE, 9, direction);
  const hid_t data = H5Gcreate2(group, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  write_hdf5(data, "S", H5T_NATIVE_FLOAT, {5, 3, 4}, sample_bytes(ScalarType::kFloat32).data());
  H5Gclose(data);
  H5Gclose(group);
  H5Fclose(file);
}

}  // namespace

void append_bytes(std::string& out, const void* value, std::size_t size, bool is_big_endian) {
  std::string bytes(static_cast<const char*>(value), size);
  if (is_big_endian) std::reverse(bytes.begin(), bytes.end());
  out += bytes;
}

std::string sample_bytes(ScalarType type, bool is_big_endian) {
  switch (type) {
    case ScalarType::kUint8:
      return values_of_type<std::uint8_t>(is_big_endian);
    case ScalarType::kInt16:
      return values_of_type<std::int16_t>(is_big_endian);
    case ScalarType::kUint16:
      return values_of_type<std::uint16_t>(is_big_endian);
    case ScalarType::kFloat32:
      return values_of_type<float>(is_big_endian);
    default:
      return values_of_type<double>(is_big_endian);
  }
}

std::vector<double> grid_values(const GridData& grid) {
  const std::size_t size = scalar_type_size(grid.type);
  std::vector<double> out(grid.values.size() / size);
  const auto convert = [&]<class T>(T) {
    for (std::size_t n = 0; n < out.size(); ++n) {
      T value;
      std::memcpy(&value, grid.values.data() + n * size, size);
      out[n] = static_cast<double>(value);
    }
  };
  switch (grid.type) {
    case ScalarType::kInt8:
      convert(std::int8_t{});
      break;
    case ScalarType::kUint8:
      convert(std::uint8_t{});
      break;
    case ScalarType::kInt16:
      convert(std::int16_t{});
      break;
    case ScalarType::kUint16:
      convert(std::uint16_t{});
      break;
    case ScalarType::kInt32:
      convert(std::int32_t{});
      break;
    case ScalarType::kUint32:
      convert(std::uint32_t{});
      break;
    case ScalarType::kInt64:
      convert(std::int64_t{});
      break;
    case ScalarType::kUint64:
      convert(std::uint64_t{});
      break;
    case ScalarType::kFloat32:
      convert(float{});
      break;
    case ScalarType::kFloat64:
      convert(double{});
      break;
  }
  return out;
}

std::string deflate_text(const std::string& text, bool is_gzip) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, MAX_WBITS + (is_gzip ? 16 : 0), 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, text.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string nifti_header(std::int16_t datatype, std::int16_t bits) {
  std::string header(352, '\0');
  set_number(header, 0, std::int32_t{348});
  const std::int16_t sizes[] = {3, 4, 3, 5, 1, 1, 1, 1};
  const float spacings[] = {1.0f, 0.5f, 1.0f, 2.0f};
  for (std::size_t i = 0; i < 8; ++i) set_number(header, 40 + 2 * i, sizes[i]);
  for (std::size_t i = 0; i < 4; ++i) set_number(header, 76 + 4 * i, spacings[i]);
  set_number(header, 70, datatype);
  set_number(header, 72, bits);
  set_number(header, 108, 352.0f);
  set_number(header, 252, std::int16_t{1});  // A qform of no rotation.
  const float offsets[] = {10.0f, 20.0f, 30.0f};
  for (std::size_t i = 0; i < 3; ++i) set_number(header, 268 + 4 * i, offsets[i]);
  header.replace(344, 4, std::string("n+1\0", 4));
  return header;
}

std::string dicom_element(std::uint16_t group, std::uint16_t element, const std::string& type, std::string value) {
  if (value.size() % 2 != 0) value += type == "UI" ? '\0' : ' ';
  std::string out;
  append_number(out, group);
  append_number(out, element);
  out += type;
  if (type == "OW" || type == "OB" || type == "SQ") {
    out += std::string(2, '\0');
    append_number(out, static_cast<std::uint32_t>(value.size()));
  } else {
    append_number(out, static_cast<std::uint16_t>(value.size()));
  }
  return out + value;
}

std::string dicom_slice(std::size_t k, const std::string& extra) {
  const auto number = [](std::uint16_t element, std::uint16_t value) {
    std::string bytes;
    append_number(bytes, value);
    return dicom_element(0x0028, element, "US", bytes);
  };
  std::string out = std::string(128, '\0') + "DICM" + dicom_element(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1");
  out += dicom_element(0x0018, 0x0088, "DS", "2");
  out += dicom_element(0x0020, 0x000E, "UI", "1.2.3");
  out += dicom_element(0x0020, 0x0013, "IS", std::to_string(5 - k));
  out += dicom_element(0x0020, 0x0032, "DS", "10\\20\\" + std::to_string(30 + 2 * k));
  out += dicom_element(0x0020, 0x0037, "DS", "1\\0\\0\\0\\1\\0");
  out += number(0x0002, 1) + dicom_element(0x0028, 0x0004, "CS", "MONOCHROME2") + number(0x0010, 3) + number(0x0011, 4);
  out += dicom_element(0x0028, 0x0030, "DS", "1\\0.5");
  out += number(0x0100, 16) + number(0x0101, 12) + number(0x0102, 11) + number(0x0103, 0) + extra;
  return out + dicom_element(0x7FE0, 0x0010, "OW", sample_bytes(ScalarType::kUint16).substr(24 * k, 24));
}

std::string tiff_file(const std::vector<std::string>& pages, std::uint32_t width, std::uint32_t height) {
  std::string out("II*\0\10\0\0\0", 8);
  for (std::size_t page = 0; page < pages.size(); ++page) {
    const auto begin = static_cast<std::uint32_t>(out.size());
    const std::vector<std::array<std::uint32_t, 2>> tags{
        {256, width}, {257, height}, {258, 8},
        {259, 1},     {262, 1},      {273, begin + 2 + 10 * 12 + 4},
        {277, 1},     {278, height}, {279, static_cast<std::uint32_t>(pages[page].size())},
        {339, 1}};
    append_number(out, static_cast<std::uint16_t>(tags.size()));
    for (const auto& [tag, value] : tags) {
      append_number(out, static_cast<std::uint16_t>(tag));
      append_number(out, std::uint16_t{4});
      append_number(out, std::uint32_t{1});
      append_number(out, value);
    }
    const std::size_t padded = (pages[page].size() + 1) / 2 * 2;
    const bool is_last = page + 1 == pages.size();
    append_number(out, is_last ? std::uint32_t{0} : static_cast<std::uint32_t>(out.size() + 4 + padded));
    out += pages[page] + std::string(padded - pages[page].size(), '\0');
  }
  return out;
}

std::string mrc_header(std::int32_t mode) {
  std::string header(1024, '\0');
  const std::int32_t words[] = {4, 3, 5, mode, 0, 0, 0, 4, 3, 5};
  for (std::size_t i = 0; i < 10; ++i) set_number(header, 4 * i, words[i]);
  const float cell[] = {2.0f, 3.0f, 10.0f, 90.0f, 90.0f, 90.0f};
  for (std::size_t i = 0; i < 6; ++i) set_number(header, 40 + 4 * i, cell[i]);
  for (std::size_t i = 0; i < 3; ++i) set_number(header, 64 + 4 * i, static_cast<std::int32_t>(i + 1));
  const float origin[] = {10.0f, 20.0f, 30.0f};
  for (std::size_t i = 0; i < 3; ++i) set_number(header, 196 + 4 * i, origin[i]);
  header.replace(208, 8, std::string("MAP DD\0\0", 8));
  return header;
}

const std::vector<GridSample>& grid_samples() {
  static const std::vector<GridSample> list = [] {
    std::vector<GridSample> out;
    const auto add = [&](const char* name, const char* file, ScalarType type, auto write,
                         std::vector<std::string> victims = {}) {
      if (victims.empty()) victims = {file};
      GridSample& sample = out.emplace_back();
      sample.name = name;
      sample.main_file = file;
      sample.victims = std::move(victims);
      sample.write = write;
      sample.type = type;
      return &sample;
    };
    using T = ScalarType;
    const auto file = [](const char* name, const std::string& text) {
      return [=](const fs::path& directory) { write_text(directory / name, text); };
    };
    add("vti", "grid.vti", T::kUint8, write_vti);
    add("vti_appended", "grid.vti", T::kFloat32, write_vti_appended);
    add("pvti", "grid.pvti", T::kUint8, write_pvti, {"grid.pvti", "high.vti"});
    add("vtm", "grid.vtm", T::kUint8, write_vtm, {"grid.vtm", "part.vti"});
    add("vtr", "grid.vtr", T::kUint8, write_vtr);
    add("pvtr", "grid.pvtr", T::kUint8, write_pvtr, {"grid.pvtr", "low.vtr"});
    add("legacy_text", "grid.vtk", T::kUint8, [](const fs::path& d) { write_legacy(d, false); });
    add("legacy_binary", "grid.vtk", T::kInt16, [](const fs::path& d) { write_legacy(d, true); });
    add("legacy_rectilinear", "grid.vtk", T::kUint8, write_legacy_rectilinear);
    add("vtkhdf", "grid.vtkhdf", T::kFloat32, write_vtkhdf);
    const std::string big = sample_bytes(T::kInt16, true), bytes = sample_bytes(T::kUint8);
    add("nrrd", "grid.nrrd", T::kInt16, file("grid.nrrd", nrrd_header("raw", "short", "endian: big\n") + big));
    add("nrrd_gzip", "grid.nrrd", T::kUint8,
        file("grid.nrrd", nrrd_header("gzip", "uchar") + deflate_text(bytes, true)));
    add("nrrd_text", "grid.nrrd", T::kFloat64, file("grid.nrrd", nrrd_header("text", "double") + values_text()));
    add("nhdr", "grid.nhdr", T::kInt16,
        [=](const fs::path& d) {
          write_text(d / "grid.nhdr", nrrd_header("raw", "int16", "endian: big\ndata file: grid.raw\n"));
          write_text(d / "grid.raw", big);
        },
        {"grid.nhdr", "grid.raw"});
    add("mha", "grid.mha", T::kInt16, [=](const fs::path& d) {
      write_meta(d, "grid.mha", "ElementType = MET_SHORT\nElementByteOrderMSB = True\n", big, "LOCAL");
    });
    add("mhd", "grid.mhd", T::kUint8,
        [=](const fs::path& d) { write_meta(d, "grid.mhd", "ElementType = MET_UCHAR\n", bytes, "grid.raw"); },
        {"grid.mhd", "grid.raw"});
    add("mhd_compressed", "grid.mhd", T::kUint8,
        [=](const fs::path& d) {
          write_meta(d, "grid.mhd", "ElementType = MET_UCHAR\nCompressedData = True\n", deflate_text(bytes, false),
                     "grid.zraw");
        },
        {"grid.mhd", "grid.zraw"});
    const std::string shorts = sample_bytes(T::kInt16);
    add("nifti", "grid.nii", T::kInt16, file("grid.nii", nifti_file(true) + shorts));
    add("nifti_gzip", "grid.nii.gz", T::kInt16, file("grid.nii.gz", deflate_text(nifti_file(true) + shorts, true)));
    add("nifti_pair", "grid.hdr", T::kInt16,
        [=](const fs::path& d) {
          write_text(d / "grid.hdr", nifti_file(false));
          write_text(d / "grid.img", shorts);
        },
        {"grid.hdr", "grid.img"});
    add("nifti2", "grid.nii", T::kFloat32, write_nifti2);
    add("slc", "grid.slc", T::kUint8, [](const fs::path& d) { write_slc(d, false); })->has_origin = false;
    add("slc_runs", "grid.slc", T::kUint8, [](const fs::path& d) { write_slc(d, true); })->has_origin = false;
    add("dicom", "", T::kUint16, write_dicom, {"a.dcm", "e.dcm"});
    add("dicom_zip", "grid.zip", T::kUint16, write_dicom_zip);
    add("dicom_frames", "grid.dcm", T::kUint16, write_dicom_frames);
    GridSample* pages = add("tiff", "grid.tif", T::kUint8, write_tiff_pages);
    pages->has_spacing = pages->has_origin = false;
    GridSample* slices = add("tiff_directory", "", T::kUint8, write_tiff_directory, {"slice8.tif", "slice12.tif"});
    slices->has_spacing = slices->has_origin = false;
    add("mrc", "grid.mrc", T::kFloat32, file("grid.mrc", mrc_header(2) + sample_bytes(T::kFloat32)));
    return out;
  }();
  return list;
}

}  // namespace tetravox::test
