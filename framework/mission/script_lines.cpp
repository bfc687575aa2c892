// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/script_lines.h"

#include <cctype>
#include <charconv>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace lapwing {
namespace {

constexpr int kDeepestTable = 32;  // as tables may be nested

struct Token {
  enum class Kind { name, number, text, sign };
  Kind kind = Kind::sign;
  std::string_view shown;  // a text without its quotes
  int line = 0;
};

// A lexer of Lua that is lenient: whatever it takes for a sign, Lua has accepted before.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : rest_(text) {
    if (rest_.starts_with("#")) skip_line();
    while (next()) {
    }
  }
  const std::vector<Token>& all() const { return all_; }

 private:
  static bool of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

  std::string_view take(std::size_t count) {
    const std::string_view taken = rest_.substr(0, count);
    for (const char c : taken) line_ += c == '\n';
    rest_.remove_prefix(taken.size());
    return taken;
  }

  void skip_line() { take(std::min(rest_.find('\n'), rest_.size())); }

  // The length of "[==[", or 0.
  static std::size_t long_bracket(std::string_view text) {
    if (!text.starts_with("[")) return 0;
    const std::size_t end = text.find_first_not_of('=', 1);
    return end != text.npos && text[end] == '[' ? end + 1 : 0;
  }

  // What stands between long brackets.
  std::string_view take_long(std::size_t opening) {
    std::string closing(opening, '=');
    closing.front() = closing.back() = ']';
    take(opening);
    const std::string_view inner = take(std::min(rest_.find(closing), rest_.size()));
    take(opening);
    return inner;
  }

  std::string_view take_quoted() {
    std::size_t end = 1;
    while (end < rest_.size() && rest_[end] != rest_[0]) end += rest_[end] == '\\' ? 2 : 1;
    const std::string_view whole = take(std::min(end + 1, rest_.size()));
    return whole.substr(1, whole.size() > 1 ? whole.size() - 2 : 0);
  }

  void add(Token::Kind kind, int line, std::string_view shown) {
    all_.push_back({kind, shown, line});
  }

  bool next() {
    if (rest_.empty()) return false;
    const char c = rest_.front();
    const int line = line_;
    if (std::isspace(static_cast<unsigned char>(c))) {
      take(1);
    } else if (rest_.starts_with("--")) {
      take(2);
      if (const std::size_t opening = long_bracket(rest_))
        take_long(opening);
      else
        skip_line();
    } else if (const std::size_t opening = long_bracket(rest_)) {
      add(Token::Kind::text, line, take_long(opening));
    } else if (c == '"' || c == '\'') {
      add(Token::Kind::text, line, take_quoted());
    } else if (std::isdigit(static_cast<unsigned char>(c))) {
      add(Token::Kind::number, line, take(number_length()));
    } else if (of_name(c)) {
      std::size_t end = 1;
      while (end < rest_.size() && of_name(rest_[end])) ++end;
      add(Token::Kind::name, line, take(end));
    } else {
      add(Token::Kind::sign, line, take(1));
    }
    return true;
  }

  std::size_t number_length() const {
    std::size_t end = 1;
    while (end < rest_.size() &&
           (of_name(rest_[end]) || rest_[end] == '.' ||
            ((rest_[end] == '-' || rest_[end] == '+') && std::tolower(rest_[end - 1]) == 'e')))
      ++end;
    return end;
  }

  std::string_view rest_;
  std::vector<Token> all_;
  int line_ = 1;
};

// A constructor: where its fields are written, and which of them are literals.
struct Field {
  int line = 0;
  const Token* literal = nullptr;  // if its value is a single token
  bool negative = false;           // a literal number with a minus
  std::shared_ptr<struct Constructor> table;
};
struct Constructor {
  std::map<std::string, Field, std::less<>> named;
  std::vector<Field> listed;
};

class TableReader {
 public:
  explicit TableReader(const std::vector<Token>& tokens) : tokens_(tokens) {}

  // From the `{` at `at`, which is left behind the `}`.
  Constructor read(std::size_t& at, int depth = 0) {
    Constructor table;
    ++at;
    while (at < tokens_.size() && !is(at, "}")) {
      Field field;
      field.line = tokens_[at].line;
      std::string key;
      if (tokens_[at].kind == Token::Kind::name && is(at + 1, "=") && !is(at + 2, "=")) {
        key = tokens_[at].shown;
        at += 2;
      } else if (is(at, "[")) {
        if (at + 1 < tokens_.size() && tokens_[at + 1].kind == Token::Kind::text && is(at + 2, "]"))
          key = tokens_[at + 1].shown;
        else
          key = "[";  // computed: no option is called so
        skip_to_end_of_key(at);
      }
      read_value(at, depth, field);
      if (key.empty())
        table.listed.push_back(std::move(field));
      else
        table.named[key] = std::move(field);
      if (is(at, ",") || is(at, ";")) ++at;
    }
    ++at;
    return table;
  }

  bool is(std::size_t at, std::string_view sign) const {
    return at < tokens_.size() && tokens_[at].kind != Token::Kind::text &&
           tokens_[at].shown == sign;
  }

 private:
  void skip_to_end_of_key(std::size_t& at) const {
    int open = 0;
    do {
      open += is(at, "[") - is(at, "]");
      ++at;
    } while (at < tokens_.size() && open > 0);
    if (is(at, "=")) ++at;
  }

  // An expression, up to the separator behind it.
  void read_value(std::size_t& at, int depth, Field& field) {
    const std::size_t first = at;
    if (is(at, "{") && depth < kDeepestTable)
      field.table = std::make_shared<Constructor>(read(at, depth + 1));
    const std::size_t behind_table = at;
    int open = 0, blocks = 0;
    while (at < tokens_.size()) {
      if (open == 0 && blocks == 0 && (is(at, ",") || is(at, ";") || is(at, "}"))) break;
      for (const char* sign : {"(", "{", "["}) open += is(at, sign);
      for (const char* sign : {")", "}", "]"}) open -= is(at, sign);
      for (const char* word : {"function", "if", "do", "repeat"}) blocks += is(at, word);
      for (const char* word : {"end", "until"}) blocks -= is(at, word);
      ++at;
    }
    if (field.table && at != behind_table) field.table = nullptr;  // {...}[1], {...} or x
    field.negative = at == first + 2 && is(first, "-");
    if (at == first + 1 || field.negative) {
      const Token& token = tokens_[at - 1];
      if (token.kind == Token::Kind::number || token.kind == Token::Kind::text)
        field.literal = &token;
    }
  }

  const std::vector<Token>& tokens_;
};

// Whether the field may be what the value was read from.
bool fits(const Field& field, const Value& value) {
  if (!field.literal) return true;
  const std::string_view shown = field.literal->shown;
  if (field.literal->kind == Token::Kind::text)
    return value.is_text() && (value.as_text() == shown || shown.find('\\') != shown.npos ||
                               (shown.starts_with("\n") && value.as_text() == shown.substr(1)));
  if (!value.is_number()) return false;
  double number = 0;
  const auto [end, code] = std::from_chars(shown.data(), shown.data() + shown.size(), number);
  if (code != std::errc{} || end != shown.data() + shown.size()) return true;  // 0x10
  return value.as_number() == (field.negative ? -number : number);
}

void locate(Value& value, const Field& field) {
  if (!fits(field, value)) return;
  if (field.table && !value.is_map() && !value.is_list()) return;
  value.with_origin({value.origin().source, field.line});
  if (!field.table) return;
  if (value.is_map())
    for (auto& [key, child] : value.as_map())
      if (const auto found = field.table->named.find(key); found != field.table->named.end())
        locate(child, found->second);
  // A list that is not written out whole has its entries elsewhere.
  if (value.is_list() && value.as_list().size() == field.table->listed.size())
    for (std::size_t i = 0; i < value.as_list().size(); ++i)
      locate(value.as_list()[i], field.table->listed[i]);
}

void locate_fields(Value& given, const Constructor& table) {
  if (!given.is_map()) return;
  for (auto& [key, child] : given.as_map())
    if (const auto found = table.named.find(key); found != table.named.end())
      locate(child, found->second);
}

}  // namespace

void locate_argument(Value& given, std::string_view text, int line) {
  const Tokens tokens(text);
  const std::vector<Token>& all = tokens.all();
  TableReader reader(all);
  for (std::size_t at = 1; at < all.size() && all[at].line <= line; ++at) {
    const bool call = all[at - 1].kind == Token::Kind::name || reader.is(at - 1, "(") ||
                      reader.is(at - 1, ")") || reader.is(at - 1, "]");
    if (all[at].line != line || !reader.is(at, "{") || !call || reader.is(at - 1, "return"))
      continue;
    return locate_fields(given, reader.read(at));
  }
}

void locate_in_result(Value& given, std::string_view text, std::string_view field) {
  const Tokens tokens(text);
  const std::vector<Token>& all = tokens.all();
  TableReader reader(all);
  for (std::size_t at = all.size(); at-- > 1;) {
    if (!reader.is(at, "{") || !reader.is(at - 1, "return")) continue;
    std::size_t from = at;
    const Constructor result = reader.read(from);
    if (from < all.size()) continue;  // of a function, not of the script
    const auto found = result.named.find(field);
    if (found != result.named.end() && found->second.table)
      locate_fields(given, *found->second.table);
    return;
  }
}

}  // namespace lapwing
