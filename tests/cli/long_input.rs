//! Huge values in every kind of place: the error stays a sentence.

use crate::command::{Folder, LEVEL};

/// Longest line of an error, with the cut that the command makes of what it does not know to be long.
const LONGEST: usize = 420;

fn expect_short(folder: &Folder, arguments: &[&str], place: &str) {
    let finished = folder.run(arguments).expect(2);
    assert!(finished.stderr.contains("error: "), "{place}: {}", finished.stderr);
    assert!(!finished.stderr.contains("panicked"), "{place}: {}", finished.stderr);
    let longest = finished.stderr.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    assert!(longest <= LONGEST, "{place}: a line of {longest} characters: {}", finished.stderr);
    assert!(finished.stderr.len() < 4 * LONGEST, "{place}: {} bytes", finished.stderr.len());
}

/// Every value and every name of a problem file in turn, as a long name, a long number and a long list.
#[test]
fn in_problem_files() {
    let folder = Folder::with_level();
    let (name, number) = ("n".repeat(100_000), "1".repeat(100_000));
    let list = format!("[{}]", vec!["\"z\""; 20_000].join(", "));
    let text = LEVEL.to_owned()
        + "stop = { stall = 3 }\nconstraints = [\"nis_mean <= 2\"]\n[simulate]\nsteps = 9\nx0 = [0]\n[filter]\nkind = \
           \"kalman\"\n";
    let values: Vec<(usize, usize)> = text
        .match_indices(" = ")
        .map(|(at, _)| (at + 3, text[at..].find(['\n', ',', '}']).map_or(text.len(), |end| at + end)))
        .filter(|(from, to)| from < to)
        .collect();
    assert!(values.len() > 25, "{} values", values.len());
    let mut refused = 0;
    for (from, to) in values {
        for value in [format!("\"{name}\""), number.clone(), list.clone(), format!("\"x + {name}\"")] {
            folder.write("p.toml", format!("{}{value}{}", &text[..from], &text[to..]));
            if folder.run(&["filter", "p.toml", "--quiet"]).code != 0 {
                refused += 1;
                expect_short(&folder, &["filter", "p.toml", "--quiet"], &text[from..to]);
            }
        }
    }
    assert!(refused > 80, "{refused} refused");
    for key in ["file", "q", "population", "model"] {
        folder.write("p.toml", text.replacen(key, &name, 1));
        expect_short(&folder, &["filter", "p.toml"], key);
    }
}

#[test]
fn in_logs_and_candidates() {
    let folder = Folder::with_level();
    let name = "n".repeat(100_000);
    let columns = (0..5000).map(|i| format!("c{i}")).collect::<Vec<_>>().join(",");
    for log in [
        format!("t,{name}\n0,1\n"),
        format!("{columns}\n1\n"),
        format!("t,z\n0,{name}\n"),
        format!("t,z\n{name},1\n"),
        format!("t,z\n0,{}\n", "9".repeat(100_000)),
        format!("t,z,{name},{name}\n0,1,2,3\n"),
    ] {
        folder.write("log.csv", &log);
        expect_short(&folder, &["tune", "problem.toml"], &log[..20]);
    }
    let folder = Folder::with_level();
    for candidates in
        [format!("{name},r\n1,2\n"), format!("q,q{name}\n"), format!("q,r\n1,{name}\n"), format!("{columns}\n1\n")]
    {
        folder.write("c.csv", &candidates);
        expect_short(&folder, &["evaluate", "problem.toml", "c.csv"], &candidates[..10]);
    }
}

#[test]
fn in_flags() {
    let folder = Folder::with_level();
    let (name, number) = ("n".repeat(100_000), "1".repeat(100_000));
    for arguments in [
        &["tune", "problem.toml", "--seed", &number][..],
        &["tune", "problem.toml", "--population", &number],
        &["tune", "problem.toml", "--algorithm", &name],
        &["tune", "problem.toml", "--objectives", &name],
        &["tune", "problem.toml", "--constraint", &name],
        &["tune", "problem.toml", "--pick", &name],
        &["tune", "problem.toml", "--precision", &name],
        &["tune", "problem.toml", "--adapter", &name],
        &["tune", "problem.toml", "--data", &name],
        &["tune", "problem.toml", "--out", &name],
        &["tune", "--resume", &name],
        &["tune", &name],
        &["filter", "problem.toml", "--parameters", &name],
        &["filter", "problem.toml", "--out", &name],
        &["compare", &name, &name],
        &["reproduce", &name],
        &["bench", "--workload", &name],
        &["init", &name],
        &[&name],
        &["tune", &format!("--{name}")],
    ] {
        expect_short(&folder, arguments, arguments[arguments.len().saturating_sub(2)]);
    }
}

#[test]
fn in_what_kfgpu_wrote() {
    let folder = Folder::with_level();
    folder.run(&["tune", "problem.toml", "--generations", "1", "--out", "out", "--quiet"]).expect(0);
    let name = "n".repeat(100_000);
    let result = folder.read("out/result.json");
    for (old, new) in
        [("\"q\"", format!("\"{name}\"")), ("\"algorithm\":\"pso\"", format!("\"algorithm\":{{\"{name}\":1}}"))]
    {
        assert!(result.contains(old), "{old} in {result}");
        folder.write("changed.json", result.replace(old, &new).replacen("\"nll\"", &format!("\"{name}\""), 1));
        expect_short(&folder, &["compare", "changed.json", "out"], old);
    }
    // A checkpoint of a problem with long names, resumed with another one.
    let long = |length: usize| folder.read("problem.toml").replace("r = {", &format!("{} = {{", "r".repeat(length)));
    folder.write("long.toml", long(2000).replace("z = \"r\"", &format!("z = \"{}\"", "r".repeat(2000))));
    folder.run(&["tune", "long.toml", "--generations", "1", "--checkpoint", "c.kfgpu", "--quiet"]).expect(0);
    expect_short(&folder, &["tune", "problem.toml", "--resume", "c.kfgpu"], "names in a checkpoint");
}
