// SPDX-License-Identifier: Apache-2.0
// What is noted of checks, the parameters that plugins are tried with, and what a plugin may say of
// itself.
#include "framework/conformance/findings.h"

#include <gtest/gtest.h>

#include <map>

#include "framework/conformance/sample_parameters.h"
#include "framework/core/error.h"

namespace lapwing {
namespace {

std::string word(Outcome outcome) {
  switch (outcome) {
    case Outcome::passed:
      return "passed";
    case Outcome::failed:
      return "failed";
    case Outcome::skipped:
      return "skipped";
    case Outcome::warned:
      return "warned";
  }
  return "?";
}

// "a passed, b failed: why"
std::string noted(Findings findings) {
  std::string text;
  for (const CheckResult& result : std::move(findings).results())
    text += (text.empty() ? "" : ", ") + result.name + " " + word(result.outcome) +
            (result.message.empty() ? "" : ": " + result.message);
  return text;
}

std::function<std::string()> saying(const char* text) {
  return [=] { return std::string(text); };
}

TEST(CheckFindings, TheFirstFailureOfACheckStays) {
  Findings findings;
  findings.expect("a", true, {});
  findings.expect("b", false, saying("first"));
  findings.expect("b", false, saying("second"));
  findings.expect("b", true, {});
  EXPECT_TRUE(findings.failed("b"));
  EXPECT_FALSE(findings.failed("a"));
  EXPECT_FALSE(findings.failed("never made"));
  EXPECT_EQ(noted(std::move(findings)), "a passed, b failed: first");
}

TEST(CheckFindings, AMessageIsMadeOnlyWhereItIsNeeded) {
  Findings findings;
  const auto never = []() -> std::string { throw std::logic_error("asked"); };
  findings.expect("a", true, never);
  findings.fail("a", "why");
  EXPECT_NO_THROW(findings.expect("a", false, never));
}

TEST(CheckFindings, OutcomesOutweighEachOther) {
  Findings findings;
  findings.skip("a", "no tool");
  findings.skip("a", "another reason");
  findings.expect("b", true, {});
  findings.skip("b", "too late");
  findings.skip("c", "no tool");
  findings.expect("c", true, {});  // made after all
  findings.expect("d", true, {});
  findings.warn("d", "odd");
  findings.warn("d", "odder");
  findings.warn("e", "odd");
  findings.fail("e", "wrong");
  findings.fail("f", "wrong");
  findings.warn("f", "odd");
  findings.skip("g", "no tool");
  findings.fail("g", "wrong");
  EXPECT_EQ(noted(std::move(findings)),
            "a skipped: no tool, b passed, c passed, d warned: odd, e failed: wrong, f failed: "
            "wrong, g failed: wrong");
}

TEST(CheckFindings, TheCaseStandsBehindTheMessage) {
  Findings findings;
  findings.set_case("order = 4");
  findings.fail("a", "why");
  findings.warn("b", "odd");
  findings.set_case("");
  findings.fail("c", "why");
  EXPECT_EQ(noted(std::move(findings)),
            "a failed: why (order = 4), b warned: odd (order = 4), c failed: why");
}

TEST(CheckFindings, NothingButWhatIsWantedIsNoted) {
  CheckOptions options;
  options.only = {"a", "b"};
  Findings findings(options);
  EXPECT_FALSE(findings.settled());
  findings.fail("other", "why");
  findings.skip("other", "why");
  findings.warn("other", "why");
  findings.fail("creation", "why");  // what stands in the way of every check
  findings.fail("a", "why");
  EXPECT_FALSE(findings.settled());
  findings.fail("b", "why");
  EXPECT_TRUE(findings.settled());
  EXPECT_EQ(noted(std::move(findings)), "creation failed: why, a failed: why, b failed: why");
  Findings all;
  all.fail("a", "why");
  EXPECT_FALSE(all.settled()) << "there may be more to find";
}

TEST(CheckFindings, WhatIsThrownIsAFinding) {
  Findings findings;
  EXPECT_TRUE(findings.survives("a", "it", [] {}));
  EXPECT_FALSE(findings.survives("b", "its call", [] { throw std::runtime_error("no"); }));
  EXPECT_FALSE(findings.survives("c", "its call", [] { throw 3; }));
  EXPECT_EQ(noted(std::move(findings)),
            "a passed, b failed: its call throws: no, c failed: its call throws something that is "
            "not an exception");
}

// Cases by their descriptions.
std::map<std::string, ParameterCase> cases_of(const ParameterTable& table) {
  std::map<std::string, ParameterCase> all;
  for (ParameterCase& one : parameter_cases(table, StandardSetting(false))) {
    EXPECT_FALSE(all.contains(one.description)) << one.description << " twice";
    // Whatever is made up must be what the table allows.
    EXPECT_NO_THROW(check(table, one.parameters)) << one.description;
    all.emplace(one.description, std::move(one));
  }
  return all;
}

TEST(ParameterCases, TryTheEndsOfEveryRange) {
  const auto all = cases_of(ParameterTable{}
                                .number("reach", 1.0, "m", "how far", between(0.5, 10))
                                .integer("order", 2, "of a polynomial", between(1, 5)));
  ASSERT_EQ(all.size(), 5u);
  EXPECT_TRUE(all.at("defaults").parameters.as_map().empty());
  EXPECT_EQ(all.at("reach = 0.500000").parameters.at("reach").as_number(), 0.5);
  EXPECT_EQ(all.at("reach = 10.000000").parameters.at("reach").as_number(), 10);
  EXPECT_EQ(all.at("order = 1").parameters.at("order").as_integer(), 1);
  EXPECT_EQ(all.at("order = 5").parameters.at("order").as_integer(), 5);
  for (const auto& [name, one] : all) EXPECT_TRUE(one.must_work) << name;
}

TEST(ParameterCases, AnExcludedEndIsApproached) {
  for (const auto& [name, one] :
       cases_of(ParameterTable{}.number("gain", 1.0, "", "a factor", {0, 10, true}))) {
    const Value* gain = one.parameters.find("gain");
    EXPECT_TRUE(!gain || gain->as_number() > 0) << name;
  }
}

TEST(ParameterCases, MakeUpWhatIsRequired) {
  const auto all = cases_of(ParameterTable{}
                                .required_number("radius", "m", "of a ball", between(2, 4))
                                .required_numbers("center", 3, "m", "world", between(-1, 1)));
  const Value& defaults = all.at("defaults").parameters;
  EXPECT_EQ(defaults.at("radius").as_number(), 3);
  EXPECT_EQ(defaults.at("center").as_list().size(), 3u);
  for (const auto& [name, one] : all) {
    EXPECT_NE(one.parameters.find("radius"), nullptr) << name;
    EXPECT_NE(one.parameters.find("center"), nullptr) << name;
  }
}

PluginEntry described(const std::function<void(PluginEntry&)>& change) {
  PluginEntry entry;
  entry.kind = "cost_term";
  entry.name = "good_name_2";
  entry.version = "1.20.3";
  entry.summary = "says what it is";
  entry.parameters = ParameterTable{}.number("reach", 1.0, "m", "how far", between(0, 10));
  change(entry);
  return entry;
}

// Why a description fails; "" where it does not.
std::string fault_of(const std::function<void(PluginEntry&)>& change) {
  std::string fault;
  for (const CheckResult& result : check_description(described(change)))
    if (result.outcome == Outcome::failed) fault += result.message;
  return fault;
}

TEST(BrokenDescription, EveryPartOfItIsJudged) {
  EXPECT_EQ(fault_of([](PluginEntry&) {}), "");
  for (const char* name : {"", "Name", "1name", "_name", "a-b", "a b", "na\xc3\xafve"})
    EXPECT_NE(fault_of([&](PluginEntry& e) { e.name = name; }).find("is not snake_case"),
              std::string::npos)
        << name;
  for (const char* version :
       {"", "1", "1.0", "1.0.", ".1.0", "1..0", "1.0.0.0", "1.0.a", "v1.0.0", "1.0.0 ", "-1.0.0"})
    EXPECT_NE(fault_of([&](PluginEntry& e) { e.version = version; }).find("is not like 1.0.0"),
              std::string::npos)
        << version;
  for (const char* summary : {"", "two\nlines"})
    EXPECT_NE(fault_of([&](PluginEntry& e) { e.summary = summary; }).find("is not one line"),
              std::string::npos);
}

TEST(BrokenDescription, ParametersAgreeWithThemselves) {
  const auto fault = [](const ParameterTable& table) {
    return fault_of([&](PluginEntry& e) { e.parameters = table; });
  };
  const auto expect_fault = [&](const ParameterTable& table, const std::string& said) {
    EXPECT_EQ(fault(table), "parameter " + said);
  };
  expect_fault(ParameterTable{}.number("Reach", 1.0, "m", "how far", between(0, 10)),
               "'Reach' has a name that is not snake_case");
  expect_fault(ParameterTable{}.number("reach", 1.0, "m", "", between(0, 10)),
               "'reach' has no summary");
  expect_fault(ParameterTable{}.number("reach", 11.0, "m", "how far", between(0, 10)),
               "'reach' has a default outside of its own range");
  EXPECT_NE(fault(ParameterTable{}.number("reach", 1.0, "m", "how far", between(3, 2)))
                .find("a range in which nothing lies"),
            std::string::npos);
}

}  // namespace
}  // namespace lapwing
