#pragma once

#include <hdf5.h>

#include <cstdint>
#include <cstring>
#include <vector>

namespace tetravox::test {

/// An HDF5 data set of any number of dimensions.
inline void write_hdf5(hid_t group, const char* name, hid_t type, std::vector<hsize_t> shape, const void* values) {
  const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  const hid_t set = H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  H5Dclose(set);
  H5Sclose(space);
}

/// An attribute of several numbers.
inline void write_hdf5_attribute(hid_t group, const char* name, hid_t type, hsize_t count, const void* values) {
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t attribute = H5Acreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(attribute, type, values);
  H5Aclose(attribute);
  H5Sclose(space);
}

/// What every VTKHDF group has.
inline void write_vtkhdf_type(hid_t group, const char* type) {
  const hsize_t two = 2;
  const std::int64_t version[2] = {1, 0};
  const hid_t pair = H5Screate_simple(1, &two, nullptr), scalar = H5Screate(H5S_SCALAR), text = H5Tcopy(H5T_C_S1);
  const hid_t first = H5Acreate2(group, "Version", H5T_NATIVE_INT64, pair, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(first, H5T_NATIVE_INT64, version);
  H5Tset_size(text, std::strlen(type));
  const hid_t second = H5Acreate2(group, "Type", text, scalar, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(second, text, type);
  H5Aclose(first);
  H5Aclose(second);
  H5Tclose(text);
  H5Sclose(pair);
  H5Sclose(scalar);
}

}  // namespace tetravox::test
