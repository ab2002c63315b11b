#include "src/optics/json_reader.h"

#include "tetravox/error.h"

#include <algorithm>
#include <set>
#include <vector>

namespace tetravox::optics {
namespace {

/// Edits (insert, delete, replace) between two short words (Wagner and Fischer 1974).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

/// What nlohmann says, without its own prefix.
std::string message_of(const nlohmann::json::exception& exception) {
  const std::string text = exception.what();
  const std::size_t end = text.find("] ");
  return text.substr(end == std::string::npos ? 0 : end + 2, 240);
}

}  // namespace

std::string printable(std::string_view text) {
  std::string line(text.substr(0, 80));
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text.size() > 80 ? line + "..." : line;
}

std::string_view nearest_word(std::string_view word, std::initializer_list<std::string_view> known) {
  if (word.size() > 64) return {};
  std::string_view nearest;
  std::size_t least = 3;
  for (const std::string_view candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least && distance < candidate.size()) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

nlohmann::json parse_json(const std::string& text, const std::string& source_name) {
  const auto fail = [&](const std::string& what) { throw Error(ErrorCode::kBadFile, source_name + ": " + what); };
  if (text.size() > kLargestJsonBytes) fail("larger than 64 MiB; this is not a scene or a transfer function");

  // Watch the parser: it calls for every key and value, with the depth at which they stand.
  using Event = nlohmann::json::parse_event_t;
  std::vector<std::set<std::string>> keys;
  std::size_t values = 0;
  const auto watch = [&](int depth, Event event, nlohmann::json& parsed) {
    if (depth > kLargestJsonDepth) fail("nested deeper than 32 levels");
    if (++values > kLargestJsonValues) fail("holds more than 4 million values");
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end) keys.pop_back();
    if (event == Event::key && !keys.back().insert(parsed.get_ref<const std::string&>()).second)
      fail("the key '" + printable(parsed.get_ref<const std::string&>()) + "' occurs twice in one object");
    return true;
  };
  try {
    return nlohmann::json::parse(text, watch);
  } catch (const nlohmann::json::exception& exception) {
    fail("not JSON: " + message_of(exception));
  }
  return {};
}

void JsonPlace::fail(const std::string& what) const {
  std::string message = *source_ + ": ";
  if (!path_.empty()) message += path_ + ": ";
  throw Error(ErrorCode::kBadFile, message + what);
}

std::optional<JsonPlace> JsonPlace::find(const char* key) const {
  if (!value_->is_object()) fail("expected an object { }, found " + std::string(value_->type_name()));
  const auto member = value_->find(key);
  if (member == value_->end()) return std::nullopt;
  JsonPlace place(*member, *source_);
  place.path_ = path_.empty() ? key : path_ + "." + key;
  return place;
}

JsonPlace JsonPlace::at(const char* key) const {
  std::optional<JsonPlace> place = find(key);
  if (!place) fail("the key '" + std::string(key) + "' is missing");
  return *place;
}

JsonPlace JsonPlace::at(std::size_t index) const {
  JsonPlace place((*value_)[index], *source_);
  place.path_ = path_ + "[" + std::to_string(index) + "]";
  return place;
}

std::size_t JsonPlace::size() const {
  if (!value_->is_array()) fail("expected an array [ ], found " + std::string(value_->type_name()));
  return value_->size();
}

double JsonPlace::number() const {
  if (!value_->is_number()) fail("expected a number, found " + std::string(value_->type_name()));
  return value_->get<double>();
}

long long JsonPlace::integer(long long smallest, long long largest) const {
  const bool is_representable =
      value_->is_number_integer() &&
      !(value_->is_number_unsigned() && value_->get<unsigned long long>() > (std::size_t{1} << 62));
  if (!is_representable || value_->get<long long>() < smallest || value_->get<long long>() > largest)
    fail("expected a whole number from " + std::to_string(smallest) + " to " + std::to_string(largest));
  return value_->get<long long>();
}

bool JsonPlace::boolean() const {
  if (!value_->is_boolean()) fail("expected true or false, found " + std::string(value_->type_name()));
  return value_->get<bool>();
}

const std::string& JsonPlace::string() const {
  if (!value_->is_string()) fail("expected a string, found " + std::string(value_->type_name()));
  return value_->get_ref<const std::string&>();
}

void JsonPlace::numbers(double* out, std::size_t count) const {
  if (size() != count)
    fail("expected " + std::to_string(count) + " numbers, found " + std::to_string(size()) + " elements");
  for (std::size_t i = 0; i < count; ++i) out[i] = at(i).number();
}

void JsonPlace::require_keys(std::initializer_list<std::string_view> known) const {
  if (!value_->is_object()) fail("expected an object { }, found " + std::string(value_->type_name()));
  for (const auto& member : value_->items()) {
    if (std::find(known.begin(), known.end(), member.key()) != known.end()) continue;
    std::string message = "unknown key '" + printable(member.key()) + "'";
    const std::string_view nearest = nearest_word(member.key(), known);
    if (!nearest.empty()) message.append("; did you mean '").append(nearest).append("'?");
    if (nearest.empty()) {
      message += "; known are:";
      for (const std::string_view word : known) message.append(" ").append(word);
    }
    fail(message);
  }
}

}  // namespace tetravox::optics
