// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/plan_digest.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "framework/core/checksum.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

constexpr const char* kDigest = "digest";
constexpr std::size_t kSectionDigits = 16;

Value in_canonical_form(const Value& value) {
  constexpr double kWhole = 9007199254740992;  // 2^53: up to here doubles are exact integers
  switch (value.type()) {
    case Value::Type::number: {
      const double number = value.as_number();
      if (std::abs(number) <= kWhole && number == std::floor(number))
        return Value(static_cast<std::int64_t>(number));
      return Value(number);
    }
    case Value::Type::list: {
      Value list = Value::list();
      for (const Value& entry : value.as_list()) list.push_back(in_canonical_form(entry));
      return list;
    }
    case Value::Type::map: {
      Value::Map entries;
      for (const auto& [key, entry] : value.as_map())
        entries.emplace_back(key, in_canonical_form(entry));
      std::sort(entries.begin(), entries.end(),
                [](const auto& a, const auto& b) { return a.first < b.first; });
      return Value(std::move(entries));
    }
    default:
      return value;
  }
}

// Of a document in canonical form.
std::map<std::string, std::string> sections_of(const Value& document) {
  std::map<std::string, std::string> sections;
  const auto add = [&](const std::string& name, const Value& value) {
    sections[name] = sha256(to_json(value, -1)).substr(0, kSectionDigits);
  };
  for (const auto& [key, value] : document.as_map()) {
    if (!value.is_map() || value.as_map().empty()) {
      add(key, value);
      continue;
    }
    for (const auto& [inner, entry] : value.as_map()) add(key + "." + inner, entry);
  }
  return sections;
}

// The records of obstacles that are not what their checksums are of.
void add_changed_records(const Value& document, std::vector<std::string>& changed) {
  const Value* environment = document.find("environment");
  const Value* obstacles = environment ? environment->find("obstacles") : nullptr;
  if (!obstacles || !obstacles->is_list()) return;
  for (std::size_t i = 0; i < obstacles->as_list().size(); ++i) {
    const Value& record = obstacles->as_list()[i];
    const Value* stated = record.find(kRecordChecksum);
    if (!stated) continue;
    Value rest = Value::map();
    for (const auto& [key, value] : record.as_map())
      if (key != kRecordChecksum) rest.set(key, value);
    if (*stated != Value(canonical_sha256(rest)))
      changed.push_back("environment.obstacles[" + std::to_string(i) + "]");
  }
}

Value canonical_document(const Value& document) {
  Value rest = Value::map();
  for (const auto& [key, value] : document.as_map())
    if (key != kDigest) rest.set(key, value);
  return in_canonical_form(rest);
}

}  // namespace

std::string canonical_sha256(const Value& value) {
  return sha256(to_json(in_canonical_form(value), -1));
}

Value digest_of(const Value& document) {
  const Value canonical = canonical_document(document);
  Value digest = Value::map(), sections = Value::map();
  digest.set("sha256", sha256(to_json(canonical, -1)));
  for (const auto& [name, hash] : sections_of(canonical)) sections.set(name, hash);
  digest.set("sections", std::move(sections));
  return digest;
}

DigestFindings check_digest(const Value& document) {
  const Value canonical = canonical_document(document);
  DigestFindings found;
  found.sha256 = sha256(to_json(canonical, -1));
  const Value* stated = document.find(kDigest);
  if (!stated) return found;
  found.stated = true;
  const Value* whole = stated->find("sha256");
  if (whole && *whole == Value(found.sha256)) return found;
  std::map<std::string, std::string> now = sections_of(canonical);
  const Value* sections = stated->find("sections");
  if (sections && sections->is_map()) {
    for (const auto& [name, hash] : sections->as_map()) {
      const auto at = now.find(name);
      if (at == now.end())
        found.changed.push_back(name + " (removed)");
      else if (hash != Value(at->second))
        found.changed.push_back(name);
      if (at != now.end()) now.erase(at);
    }
    for (const auto& [name, hash] : now) found.changed.push_back(name + " (added)");
  }
  add_changed_records(document, found.changed);
  if (found.changed.empty()) found.changed.push_back(kDigest);
  return found;
}

}  // namespace lapwing
