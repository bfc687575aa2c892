// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/patch.h"

#include <algorithm>

#include "framework/core/json.h"

namespace lapwing {
namespace {

Value* node_of(Value& document, const OptionPath& path, std::size_t steps) {
  return const_cast<Value*>(find_at(document, path, steps));
}

// The node that holds the last step; InputError where there is none.
Value& holder_of(Value& document, const OptionPath& path) {
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    if (!find_at(document, path, i + 1))
      throw InputError("there is no " + to_text({path.begin(), path.begin() + i + 1}));
  Value& holder = *node_of(document, path, path.size() - 1);
  const PathStep& last = path.back();
  const OptionPath above(path.begin(), path.end() - 1);
  const std::string name = above.empty() ? "the document" : to_text(above);
  if (last.index == 0 && !holder.is_map())
    throw InputError(name + " is " + holder.describe_type() + ", and has no '" + last.key + "'");
  if (last.index > 0 && !holder.is_list())
    throw InputError(name + " is " + holder.describe_type() + ", not a list");
  if (last.index > 0 && last.index > holder.as_list().size())
    throw InputError("there is no " + to_text(path) + "; the list has " +
                     std::to_string(holder.as_list().size()) +
                     " entries, and is set whole to gain one");
  return holder;
}

// Applies one; what takes it back.
Change apply_change(Value& document, const Change& change) {
  Value& holder = holder_of(document, change.path);
  Value* old = node_of(holder, {change.path.back()}, 1);
  Change inverse{change.path, old ? std::optional<Value>(*old) : std::nullopt};
  if (change.value) {
    if (old)
      *old = *change.value;
    else
      holder.set(change.path.back().key, *change.value);
    return inverse;
  }
  if (change.path.back().index > 0)
    throw InputError(to_text(change.path) + ": a list is set whole to lose an entry");
  if (!old) throw InputError("there is no " + to_text(change.path) + " to remove");
  auto& map = holder.as_map();
  std::erase_if(map, [&](const auto& entry) { return entry.first == change.path.back().key; });
  return inverse;
}

bool keys_have_paths(const Value& map) {
  return std::all_of(map.as_map().begin(), map.as_map().end(),
                     [](const auto& entry) { return is_path_key(entry.first); });
}

void add_difference(const Value& from, const Value& to, OptionPath& at, Patch& found) {
  if (same_options(from, to)) return;
  const auto below = [&](PathStep step, const Value& a, const Value& b) {
    at.push_back(std::move(step));
    add_difference(a, b, at, found);
    at.pop_back();
  };
  const bool deeper = at.size() + 1 < kDeepestPath;
  if (deeper && from.is_map() && to.is_map() && keys_have_paths(from) && keys_have_paths(to)) {
    for (const auto& [key, value] : from.as_map()) {
      if (const Value* other = to.find(key)) {
        below({key, 0}, value, *other);
        continue;
      }
      at.push_back({key, 0});
      found.push_back({at, std::nullopt});
      at.pop_back();
    }
    for (const auto& [key, value] : to.as_map()) {
      if (from.find(key)) continue;
      at.push_back({key, 0});
      found.push_back({at, value});
      at.pop_back();
    }
    return;
  }
  // Lists of plain values are one thing: a position.
  const auto plain = [](const Value& list) {
    return std::none_of(list.as_list().begin(), list.as_list().end(),
                        [](const Value& entry) { return entry.is_map() || entry.is_list(); });
  };
  if (deeper && !at.empty() && from.is_list() && to.is_list() && !plain(to) &&
      from.as_list().size() == to.as_list().size()) {
    for (std::size_t i = 0; i < from.as_list().size(); ++i)
      below({"", i + 1}, from.as_list()[i], to.as_list()[i]);
    return;
  }
  found.push_back({at, to});
}

std::string type_in(const Value& map) {
  const Value* type = map.find("type");
  return type && type->is_text() ? type->as_text() : "";
}

}  // namespace

Patch patch_from(const Value& list, const std::string& what) {
  if (!list.is_list())
    throw InputError(what + ": expected a list of changes, got " + list.describe_type());
  if (list.as_list().size() > kMostChanges)
    throw InputError(what + ": more than " + std::to_string(kMostChanges) + " changes");
  Patch patch;
  for (const Value& entry : list.as_list()) {
    const Value *path = entry.find("path"), *value = entry.find("value"),
                *remove = entry.find("remove");
    const bool removes = remove && *remove == Value(true);
    if (!entry.is_map() || entry.as_map().size() != 2 || !path || !path->is_text() ||
        !(value || removes))
      throw InputError(what +
                       ": expected changes {\"path\", \"value\"} or {\"path\", \"remove\": "
                       "true}");
    patch.push_back(
        {option_path(path->as_text()), value ? std::optional<Value>(*value) : std::nullopt});
  }
  return patch;
}

Value to_value(const Patch& patch) {
  Value list = Value::list();
  for (const Change& change : patch) {
    Value entry = Value::map();
    entry.set("path", to_text(change.path));
    if (change.value)
      entry.set("value", *change.value);
    else
      entry.set("remove", true);
    list.push_back(std::move(entry));
  }
  return list;
}

Patch apply_patch(Value& document, const Patch& patch) {
  Value changed = document;
  Patch inverse;
  for (const Change& change : patch) inverse.push_back(apply_change(changed, change));
  std::reverse(inverse.begin(), inverse.end());
  document = std::move(changed);
  return inverse;
}

Patch difference(const Value& from, const Value& to) {
  Patch found;
  OptionPath at;
  add_difference(from, to, at, found);
  return found;
}

bool overlap(const Patch& a, const Patch& b) {
  return std::any_of(a.begin(), a.end(), [&](const Change& one) {
    return std::any_of(b.begin(), b.end(),
                       [&](const Change& other) { return overlap(one.path, other.path); });
  });
}

bool same_options(const Value& a, const Value& b) {
  if (a.is_map() && b.is_map())
    return a.as_map().size() == b.as_map().size() &&
           std::all_of(a.as_map().begin(), a.as_map().end(), [&](const auto& entry) {
             const Value* other = b.find(entry.first);
             return other && same_options(entry.second, *other);
           });
  if (a.is_list() && b.is_list())
    return std::equal(a.as_list().begin(), a.as_list().end(), b.as_list().begin(),
                      b.as_list().end(), same_options);
  if (a.is_number() && b.is_number()) return a.as_number() == b.as_number();
  return a == b;
}

Value without_origins(const Value& value) {
  if (value.is_list()) {
    Value list = Value::list();
    for (const Value& entry : value.as_list()) list.push_back(without_origins(entry));
    return list;
  }
  if (value.is_map()) {
    Value map = Value::map();
    for (const auto& [key, child] : value.as_map()) map.set(key, without_origins(child));
    return map;
  }
  Value plain = value;
  plain.with_origin({});
  return plain;
}

Value layer_of(const Value& script, const Value& document) {
  Value layer = Value::map();
  for (const auto& [key, value] : document.as_map()) {
    const Value* base = script.find(key);
    if (base && same_options(*base, value)) continue;
    const bool within = base && base->is_map() && value.is_map() && !value.as_map().empty() &&
                        type_in(*base) == type_in(value);
    layer.set(key, within ? layer_of(*base, value) : value);
  }
  return layer;
}

}  // namespace lapwing
