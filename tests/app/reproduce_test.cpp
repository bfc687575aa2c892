// SPDX-License-Identifier: Apache-2.0
// lapwing reproduce, as a user runs it, with tables of the test's own.
#include "framework/core/json.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

constexpr const char* kInstance = "5 1\n0 0 0\n2 0 0\n1 1 7\n1 -1 3\n";

constexpr const char* kTable = R"(
title: Tours of four nodes
thesis: table 9.1
studies:
  nodes:
    command: tour
    arguments: ["{data:nodes.txt}"]
    options: {solver: [greedy, local_search]}
    quick: {solver: greedy}
columns: [{name: score, figure: score}]
rows:
  - {name: Local search, where: {solver: local_search}, thesis: [9], quick: false}
  - {name: Greedy, where: {solver: greedy}, thesis: [8]}
ranks: [{above: Local search, below: Greedy, column: score}]
differs: [Four nodes are no town.]
)";

class Reproduce : public CommandLine {
 protected:
  Reproduce() {
    home_ = folder_ / "home";
    fs::create_directories(home_ / "configs");
    for (const char* name : {"scripts", "examples"})
      fs::create_symlink(fs::path(LAPWING_SOURCE_DIR) / name, home_ / name);
    write_table(kTable);
    fs::create_directories(folder_ / "data");
    write_file_atomically(folder_ / "data/nodes.txt", kInstance);
    ::setenv("LAPWING_HOME", home_.c_str(), 1);
  }
  ~Reproduce() override { ::unsetenv("LAPWING_HOME"); }

  void write_table(const std::string& text) {
    write_file_atomically(home_ / "configs/reproduce/9.1.yaml", text);
  }
  Finished reproduce(std::vector<std::string> more) {
    more.insert(more.begin(), "reproduce");
    return run(more);
  }

  fs::path home_;
};

TEST_F(Reproduce, MakesATableBesideTheThesis) {
  const Finished listed = reproduce({"list"});
  EXPECT_EQ(listed.status, 0) << listed.err;
  EXPECT_NE(listed.out.find("Tours of four nodes"), std::string::npos) << listed.out;
  const Finished made = reproduce({"9.1", "--data", "data", "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  const Value answer = from_json(made.out, "answer");
  EXPECT_EQ(answer.at("status").as_text(), "ok");
  const Value& cell = answer.at("rows").as_list().at(0).at("cells").at("score");
  EXPECT_EQ(cell.at("ours").as_number(), 10) << "both nodes lie on a way of 4.83 m, of 5 m";
  EXPECT_EQ(cell.at("thesis").as_number(), 9);
  const std::string text = read_file(folder_ / "out/reproduce/9.1/table.txt");
  EXPECT_NE(text.find("Four nodes are no town."), std::string::npos) << text;
  for (const char* name : {"table.csv", "report.html", "nodes.json", "reproduction.json"})
    EXPECT_TRUE(fs::exists(folder_ / "out/reproduce/9.1" / name)) << name;
}

TEST_F(Reproduce, AQuickOneSaysWhatItLeavesOut) {
  const Finished made = reproduce({"9.1", "--data", "data", "--quick"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.out.find("Quick, nodes: solver \"greedy\" in place of [\"greedy\","),
            std::string::npos)
      << made.out;
  EXPECT_NE(made.out.find("One of them has no figure"), std::string::npos) << made.out;
  EXPECT_TRUE(fs::exists(folder_ / "out/reproduce/9.1_quick/table.txt"));
}

TEST_F(Reproduce, GoesOnWithWhatIsThereAndOnlyWithTheSame) {
  ASSERT_EQ(reproduce({"9.1", "--data", "data", "--quiet"}).status, 0);
  const fs::path folder = folder_ / "out/reproduce/9.1";
  const std::string before = read_file(folder / "table.csv");
  const Finished again = reproduce({"9.1", "--data", "data"});
  EXPECT_EQ(again.status, 2);
  EXPECT_NE(again.err.find("continue it with --resume"), std::string::npos) << again.err;
  // What is done is not done again: its answer stands.
  std::string answer = read_file(folder / "nodes.json");
  const Finished resumed = reproduce({"9.1", "--data", "data", "--resume"});
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(read_file(folder / "table.csv"), before);
  EXPECT_EQ(read_file(folder / "nodes.json"), answer);
  // Another program, or another definition.
  const std::string stated = read_file(folder / "reproduction.json");
  std::string older = stated;
  older.replace(older.find("lapwing "), 8, "lapwing 0.0.");
  write_file_atomically(folder / "reproduction.json", older);
  const Finished other = reproduce({"9.1", "--data", "data", "--resume"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("of another version (program is"), std::string::npos) << other.err;
  // The same number, but another build.
  std::string built = stated;
  const std::size_t sum = built.find('"', built.find("\"executable\":") + 13) + 1;
  built.replace(sum, 4, "0000");
  write_file_atomically(folder / "reproduction.json", built);
  const Finished rebuilt = reproduce({"9.1", "--data", "data", "--resume"});
  EXPECT_NE(rebuilt.err.find("of another version (executable is"), std::string::npos)
      << rebuilt.err;
  write_file_atomically(folder / "reproduction.json", stated);
  // Words may change, what the studies are told may not, nor what they read.
  write_table(std::string(kTable) + "\n# changed\n");
  EXPECT_EQ(reproduce({"9.1", "--data", "data", "--resume"}).status, 0);
  std::string more = kTable;
  more.replace(more.find("[greedy, local_search]"), 22, "[greedy, local_search, cost_benefit]");
  write_table(more);
  EXPECT_NE(reproduce({"9.1", "--data", "data", "--resume"})
                .err.find("(study 'nodes' was told something else)"),
            std::string::npos);
  write_table(kTable);
  // No result depends on a document; on a configuration it may.
  write_file_atomically(home_ / "configs/README.md", "words\n");
  EXPECT_EQ(reproduce({"9.1", "--data", "data", "--resume"}).status, 0);
  write_file_atomically(home_ / "configs/more.yaml", "seed: 2\n");
  EXPECT_NE(reproduce({"9.1", "--data", "data", "--resume"}).err.find("(configs is"),
            std::string::npos);
  fs::remove(home_ / "configs/more.yaml");
  write_file_atomically(folder_ / "data/nodes.txt", std::string(kInstance) + "3 3 1\n");
  const Finished others = reproduce({"9.1", "--data", "data", "--resume"});
  EXPECT_NE(others.err.find("nodes.txt' is another one)"), std::string::npos) << others.err;
}

TEST_F(Reproduce, AStudyIsCorrectedWithoutTheLossOfTheOthers) {
  std::string text = kTable;
  const std::string second =
      "  more: {command: tour, arguments: [\"{data:nodes.txt}\"], options: "
      "{solvr: greedy}}\n";
  text.insert(text.find("columns:"), second);
  text.replace(text.find("{name: Local search,"), 20, "{name: Local search, study: nodes,");
  text.replace(text.find("{name: Greedy,"), 14, "{name: Greedy, study: nodes,");
  write_table(text);
  const Finished failed = reproduce({"9.1", "--data", "data"});
  EXPECT_EQ(failed.status, 2);
  EXPECT_NE(failed.err.find("study 'more' of table 9.1"), std::string::npos) << failed.err;
  const std::string made = read_file(folder_ / "out/reproduce/9.1/nodes.json");
  text.replace(text.find("solvr"), 5, "solver");
  write_table(text);
  const Finished corrected = reproduce({"9.1", "--data", "data", "--resume"});
  EXPECT_EQ(corrected.status, 0) << corrected.err;
  EXPECT_EQ(read_file(folder_ / "out/reproduce/9.1/nodes.json"), made);
  // Now it is made, and may change no more.
  text.replace(text.find("{solver: greedy}}"), 17, "{solver: local_search}}");
  write_table(text);
  EXPECT_NE(reproduce({"9.1", "--data", "data", "--resume"})
                .err.find("(study 'more' was told something else)"),
            std::string::npos);
}

TEST_F(Reproduce, TablesShareStudiesInAnyOrder) {
  const std::string shared = R"(
title: The same tours
thesis: table 9.2
from: "9.1"
columns: [{name: score, figure: score}]
rows: [{name: Greedy, where: {solver: greedy}}]
differs: [Four nodes are no town.]
)";
  write_file_atomically(home_ / "configs/reproduce/9.2.yaml", shared);
  for (const auto& [first, second] : {std::pair{"9.1", "9.2"}, {"9.2", "9.1"}}) {
    const std::string out = std::string("from_") + first;
    ASSERT_EQ(reproduce({first, "--data", "data", "-o", out}).status, 0);
    const std::string made = read_file(folder_ / out / "9.1/nodes.json");
    const Finished other = reproduce({second, "--data", "data", "-o", out});
    EXPECT_EQ(other.status, 0) << other.err;
    EXPECT_EQ(read_file(folder_ / out / "9.1/nodes.json"), made);
    for (const char* table : {"9.1", "9.2"}) {
      EXPECT_TRUE(fs::exists(folder_ / out / table / "table.txt")) << table;
      const Finished again = reproduce({table, "--data", "data", "-o", out});
      EXPECT_NE(again.err.find("continue it with --resume"), std::string::npos) << again.err;
    }
  }
}

TEST_F(Reproduce, AFigureShowsPicturesOfItsRuns) {
  for (const char* name : {"configs/vehicles", "configs/cameras"})
    fs::copy(fs::path(LAPWING_SOURCE_DIR) / name, home_ / name);
  write_file_atomically(home_ / "configs/reproduce/hop.lua", film("name = 'hop'"));
  write_table(R"(
title: A hop
thesis: figure 9.1
studies:
  hop: {command: run, arguments: ["{here}/hop.lua"]}
  fast:
    command: run
    arguments: ["{here}/hop.lua"]
    options: {set: duration=6, from: "{study:hop}/plan.json"}
pictures:
  - {title: The path, study: hop, section: Path, blocks: [Path from above]}
  - {title: How fast, study: fast, section: Motion, blocks: [Speed across]}
differs: [Hops are others.]
)");
  const Finished made = reproduce({"9.1"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(made.out.rfind("A hop (figure 9.1).\n", 0), 0u) << made.out;
  const fs::path folder = folder_ / "out/reproduce/9.1";
  const std::string page = read_file(folder / "report.html");
  for (const char* part : {"The path", "Path from above", "How fast", "Speed across"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(page.find("Path from the south"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "hop/plan.json"));
  const Finished again = reproduce({"9.1", "--resume"});
  EXPECT_EQ(again.status, 0) << "what one study made for another is no input of it: " << again.err;
  // A picture that is not there.
  write_table(R"(
title: A hop
thesis: figure 9.1
studies:
  hop: {command: run, arguments: ["{here}/hop.lua"]}
pictures: [{title: The path, study: hop, section: Way}]
)");
  const Finished wrong = reproduce({"9.1", "-o", "wrong"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("study 'hop': its report has no section 'Way'; there are 'Summary'"),
            std::string::npos)
      << wrong.err;
}

TEST_F(Reproduce, SaysThatAPlanIsNotCertified) {
  for (const char* name : {"configs/vehicles", "configs/cameras"})
    fs::copy(fs::path(LAPWING_SOURCE_DIR) / name, home_ / name);
  write_file_atomically(home_ / "configs/reproduce/hop.lua",
                        film("name = 'hop', duration = 0.5, hard = 0.01"));
  write_table(R"(
title: A hop
thesis: figure 9.1
studies: {hop: {command: run, arguments: ["{here}/hop.lua"]}}
columns: [{name: planning, figure: seconds/solve}]
rows: [{name: a hop}]
)");
  const Finished made = reproduce({"9.1", "--json", "--threads", "1"});
  ASSERT_EQ(made.status, 0) << made.err;
  const Value answer = from_json(made.out, "answer");
  ASSERT_EQ(answer.at("warnings").as_list().size(), 1u);
  const std::string said = answer.at("warnings").as_list()[0].as_text();
  EXPECT_EQ(said.rfind("The plan of study 'hop' is not certified: its status is '", 0), 0u) << said;
  const fs::path folder = folder_ / "out/reproduce/9.1";
  EXPECT_NE(read_file(folder / "table.txt").find("! " + said), std::string::npos);
  EXPECT_NE(read_file(folder / "report.html").find("is not certified"), std::string::npos);
}

TEST_F(Reproduce, AMistakeInOneTableLeavesTheOthers) {
  write_file_atomically(home_ / "configs/reproduce/9.2.yaml",
                        "title: t\nthesis: table 9.2\nfrom: \"9.2\"\n");
  const Finished listed = reproduce({"list"});
  EXPECT_EQ(listed.status, 2);
  EXPECT_NE(listed.out.find("Tours of four nodes"), std::string::npos) << listed.out;
  EXPECT_NE(listed.err.find("9.2.yaml:3"), std::string::npos) << listed.err;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--quick"}, {"-o", "other"}, {"--threads", "1"}}) {
    std::vector<std::string> asked{"list"};
    asked.insert(asked.end(), words.begin(), words.end());
    EXPECT_EQ(reproduce(asked).status, 2) << words.front();
  }
  EXPECT_EQ(reproduce({"9.1", "--data", "data"}).status, 0);
  EXPECT_NE(reproduce({"fig_9.1"}).err.find("did you mean '9.1'?"), std::string::npos);
  // Before any study is begun.
  std::string text = kTable;
  text.replace(text.find("{data:nodes.txt}"), 16, "{hear}/nodes.txt");
  write_table(text);
  const Finished place = reproduce({"9.1", "--data", "data", "-o", "other"});
  EXPECT_EQ(place.status, 2);
  EXPECT_NE(place.err.find("no place {hear}"), std::string::npos) << place.err;
  EXPECT_NE(place.err.find("9.1.yaml:"), std::string::npos) << place.err;
  text = kTable;
  text.replace(text.find("{data:nodes.txt}"), 16, "{study:nodes}/nodes.txt");
  write_table(text);
  const Finished itself = reproduce({"9.1", "--data", "data", "-o", "other"});
  EXPECT_NE(itself.err.find("study 'nodes': no study 'nodes' before it"), std::string::npos)
      << itself.err;
  EXPECT_FALSE(fs::exists(folder_ / "other"));
  // A place of a record that is not there, after them.
  text = kTable;
  text.replace(text.find("figure: score"), 13, "figure: skore");
  write_table(text);
  const Finished figure = reproduce({"9.1", "--data", "data", "-o", "third"});
  EXPECT_EQ(figure.status, 2);
  EXPECT_NE(figure.err.find("no record of study 'nodes' has 'skore'"), std::string::npos)
      << figure.err;
  // Pairs by what no record has.
  write_table(std::string(kTable) + "paired: {to: Greedy, column: score, by: seeed}\n");
  const Finished by = reproduce({"9.1", "--data", "data", "-o", "third", "--resume"});
  EXPECT_EQ(by.status, 2);
  EXPECT_NE(by.err.find("no record of study 'nodes' has 'seeed'"), std::string::npos) << by.err;
  // A method that none of them used.
  text = kTable;
  text.replace(text.find("{solver: greedy}, thesis"), 16, "{solver: gredy}");
  write_table(text);
  const Finished row = reproduce({"9.1", "--data", "data", "-o", "third", "--resume"});
  EXPECT_EQ(row.status, 2);
  EXPECT_NE(row.err.find("row 'Greedy': study 'nodes' has no record with solver \"gredy\"; there "
                         "are \"greedy\", \"local_search\""),
            std::string::npos)
      << row.err;
  text = kTable;
  text.replace(text.find("{solver: greedy}, thesis"), 16, "{solvr: greedy}");
  write_table(text);
  const Finished key = reproduce({"9.1", "--data", "data", "-o", "third", "--resume"});
  EXPECT_EQ(key.status, 2);
  EXPECT_NE(key.err.find("no record of study 'nodes' has 'solvr'; the first has "),
            std::string::npos)
      << key.err;
  write_table(kTable);
  EXPECT_EQ(reproduce({"9.1", "--data", "data", "-o", "third", "--resume"}).status, 0)
      << "what was done is not lost";
}

TEST_F(Reproduce, IsNoCommandForMpirun) {
  ::setenv("OMPI_COMM_WORLD_SIZE", "2", 1);
  for (const char* rank : {"0", "1"}) {
    ::setenv("OMPI_COMM_WORLD_RANK", rank, 1);
    const Finished finished = reproduce({"9.1", "--data", "data"});
    const bool first = *rank == '0';
    EXPECT_EQ(finished.status, first ? 2 : 0);
    EXPECT_EQ(finished.err.find("mpirun started 2 processes") != std::string::npos, first)
        << finished.err;
  }
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"}) ::unsetenv(name);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Reproduce, RefusesWhatIsNotThere) {
  const Finished unknown = reproduce({"9.2"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("no table or figure '9.2' (did you mean '9.1'?); there are 9.1"),
            std::string::npos)
      << unknown.err;
  const Finished missing = reproduce({"9.1"});
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("table 9.1 needs data that are not there: nodes.txt"),
            std::string::npos)
      << missing.err;
  EXPECT_FALSE(fs::exists(folder_ / "out")) << "nothing is begun";
  write_file_atomically(folder_ / "data/nodes.txt", "no instance");
  const Finished bad = reproduce({"9.1", "--data", "data", "--json"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_NE(from_json(bad.out, "answer").at("error").as_text().find("study 'nodes' of table 9.1"),
            std::string::npos)
      << bad.out;
  // The reason is said once, and the folder is free for a corrected file.
  EXPECT_FALSE(fs::exists(folder_ / "out/reproduce/9.1"));
  const Finished once = reproduce({"9.1", "--data", "data"});
  const std::size_t reason = once.err.find("nodes.txt:1");
  EXPECT_NE(reason, std::string::npos) << once.err;
  EXPECT_EQ(once.err.find("nodes.txt:1", reason + 1), std::string::npos) << once.err;
  write_file_atomically(folder_ / "data/nodes.txt", kInstance);
  EXPECT_EQ(reproduce({"9.1", "--data", "data"}).status, 0);
  fs::create_directories(folder_ / "full");
  fs::create_directories(folder_ / "full/9.1");
  write_file_atomically(folder_ / "full/9.1/mine.txt", "mine");
  const Finished full = reproduce({"9.1", "--data", "data", "-o", "full"});
  EXPECT_EQ(full.status, 2);
  EXPECT_NE(full.err.find("not of a reproduction"), std::string::npos) << full.err;
}

}  // namespace
}  // namespace lapwing
