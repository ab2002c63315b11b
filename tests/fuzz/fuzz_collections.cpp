// PVD, VTM and PVTU text: any bytes end in a collection that keeps its promises, or in an Error.

#include "src/io/collections.h"
#include "tetravox/error.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

void parse_as_pvd(const std::string& text) {
  const tetravox::io::PvdCollection collection = tetravox::io::parse_pvd(text, "fuzz.pvd");
  require(!collection.entries.empty() && !collection.times.empty());
  std::size_t files = 0;
  for (std::size_t i = 0; i < collection.times.size(); ++i) {
    require(std::isfinite(collection.times[i]) && (i == 0 || collection.times[i - 1] < collection.times[i]));
    files += tetravox::io::files_of_step(collection, i).size();
  }
  require(files == collection.entries.size());
}

void parse_as_list(const std::string& text) {
  const tetravox::io::FileList list = tetravox::io::parse_file_list(text, "fuzz.vtm");
  require(!list.files.empty() && list.files.size() <= tetravox::io::kMostCollectionFiles);
  for (const std::string& file : list.files) require(!tetravox::io::resolve_path("/data/fuzz.vtm", file).empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const auto parse : {parse_as_pvd, parse_as_list}) {
    try {
      parse(text);
    } catch (const tetravox::Error&) {
    }
  }
  return 0;
}
