//! `kfgpu init` on logs as loggers and spreadsheets write them, and `[data]` keys that read them again.

use std::fmt::Write as _;

use crate::command::{Finished, Folder, LEVEL};

/// A slow wave with a fast pattern for noise.
fn wave(k: u32) -> f64 {
    10.0 * (f64::from(k) / 15.0).sin() + 0.4 * (f64::from(k * 7919 % 13) - 6.0)
}

/// A log of these lines after a header.
fn lines(header: &str, rows: u32, line: impl Fn(u32) -> String) -> String {
    (0..rows).fold(format!("{header}\n"), |mut text, k| {
        let _ = writeln!(text, "{}", line(k));
        text
    })
}

/// Drafts `log`, and runs the draft's baseline over it.
struct Drafted {
    toml: String,
    stderr: String,
    filtered: Finished,
}

fn drafted(log: &str) -> Drafted {
    let folder = Folder::new();
    folder.write("log.csv", log);
    let stderr = folder.run(&["init", "log.csv", "--out", "p.toml"]).expect(0).stderr;
    let filtered = folder.run(&["filter", "p.toml"]).expect(0);
    Drafted { toml: folder.read("p.toml"), stderr, filtered }
}

fn refused(log: &str) -> String {
    let folder = Folder::new();
    folder.write("log.csv", log);
    folder.run(&["init", "log.csv"]).refusal()
}

#[track_caller]
fn says(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} in: {text}");
    }
}

#[test]
fn times_of_a_day_and_dates_in_one_order_are_read() {
    let clock = |k: u32| format!("10:{:02}:{:02}.0,{}", 15 + k / 30, k % 30 * 2, k * 3 % 7);
    let draft = drafted(&lines("time,z", 200, clock));
    says(&draft.toml, &["\ntime = \"time\"", "measurements = [\"z\"]"]);
    says(&draft.filtered.stderr, &["time 10:15:00.0 to 10:21:38.0 (398 s)", "dt: 2 s, regular"]);
    for (date, shown) in
        [("{:02}.05.2024 10:15:00", "01.05.2024 10:15:00"), ("2024/05/{:02} 10:15", "2024/05/01 10:15")]
    {
        let draft = drafted(&lines("when,z", 20, |k| {
            format!("{},{}", date.replace("{:02}", &format!("{:02}", k + 1)), wave(k))
        }));
        says(&draft.filtered.stderr, &[shown, "dt: 86400 s, regular"]);
    }
}

#[test]
fn times_that_could_mean_two_things_are_errors_with_their_place() {
    let message = refused(&lines("time,z", 20, |k| format!("03/05/2024 10:{k:02},{}", wave(k))));
    says(&message, &["log.csv:2:1", "\"time\"", "03/05/2024 10:00", "day and month, or month and day?"]);
    let message = refused(&lines("z,when", 20, |k| format!("{},10:{k:02}", wave(k))));
    says(&message, &["log.csv:2:", "\"when\"", "10:00", "write hh:mm:ss"]);
    let robot = |k: u32| format!("\"[17849000{k:02},46481370]\",{}", wave(k));
    says(&refused(&lines("stamp,z", 20, robot)), &["log.csv:2:1", "1784900000.046481370"]);
    // One bad cell in the middle of a time column.
    let message =
        refused(&lines("t,z", 40, |k| if k == 20 { format!("boot,{}", wave(k)) } else { format!("{k},{}", wave(k)) }));
    says(&message, &["log.csv:22:1", "\"t\"", "boot"]);
}

#[test]
fn times_that_do_not_increase_are_left_out_aloud() {
    let seconds = drafted(&lines("t,z", 60, |k| format!("{},{}", k / 10, wave(k))));
    says(&seconds.stderr, &["warning: column \"t\"", "stands still at line 3", "rows 0, 1, 2, ... s"]);
    assert!(!seconds.toml.contains("\ntime ="), "{}", seconds.toml);
    let unsorted = drafted(&lines("stamp_us,z", 60, |k| {
        format!("{},{}", 1_477_010_443_000_000_u64 + u64::from(k ^ 3) * 50_000, wave(k))
    }));
    says(&unsorted.stderr, &["warning: column \"stamp_us\"", "goes back at line 3"]);
    says(&unsorted.toml, &["measurements = [\"z\"]"]);
}

#[test]
fn rows_of_sums_and_units_are_no_data() {
    let body = lines("time,alt,pressure", 120, |k| {
        format!("{:.1},{},{}", 0.1 * f64::from(k), 2200.0 + wave(k), 77500.0 - wave(k + 3))
    });
    let draft = drafted(&(body.clone() + "mean,2200.1,77500.2\n"));
    says(&draft.stderr, &["line 122", "\"mean\""]);
    says(&draft.toml, &["\ntime = \"time\"", "skip_lines = [122]"]);
    says(&draft.filtered.stderr, &["120 rows", "dt: 0.1 s, regular"]);

    let draft = drafted(&body.replacen("pressure\n", "pressure\ns,m,Pa\n", 1));
    says(&draft.stderr, &["line 2 looks like a row of units (s, m, Pa)"]);
    says(&draft.toml, &["skip_lines = [2]", "unit = \"m^2\"", "unit = \"Pa^2/s"]);
    says(&draft.filtered.stderr, &["120 rows"]);

    let draft = drafted(&body.replacen("time,", "FIRMWARE_VER,v2024.12.30\nDEVICE_ID,0042\ntime,", 1));
    says(&draft.stderr, &["line 3 is taken for the header"]);
    says(&draft.toml, &["header_line = 3"]);
    says(&draft.filtered.stderr, &["120 rows"]);

    let draft = drafted(&body.replacen("time,alt,pressure", "# v2024\n#\ntime (s),alt (m),pressure (Pa)", 1));
    says(&draft.toml, &["unit = \"m^2\""]);
    assert!(!draft.toml.contains("header_line"), "{}", draft.toml);
}

#[test]
fn a_line_left_out_must_not_hold_numbers() {
    let folder = Folder::with_level();
    folder.write("problem.toml", LEVEL.replace("time = \"t\"", "time = \"t\"\nskip_lines = [7]"));
    says(&folder.run(&["filter", "problem.toml"]).refusal(), &["log.csv:7", "skip_lines"]);
}

#[test]
fn decimal_commas_are_read_or_named() {
    let comma = |value: f64| format!("{value:.6}").replace('.', ",");
    let row = |k: u32| format!("178490000{},5465;{};{}", k % 10, comma(wave(k)), comma(-wave(k + 5)));
    let semicolons = lines("Zeit [s];Position x [m];Position y [m]", 10, row);
    let draft = drafted(&semicolons);
    says(&draft.stderr, &["decimal commas (decimal = \",\")"]);
    says(
        &draft.toml,
        &["decimal = \",\"", "time = \"Zeit [s]\"", "\"Position x [m]\", \"Position y [m]\"", "unit = \"m^2\""],
    );
    says(&draft.filtered.stderr, &["10 rows", "dt: 1 s, regular"]);

    let quoted =
        |k: u32| format!("[INFO],\"178490000{k},5\",[logger],\"{}\",\"{}\"", comma(wave(k)), comma(wave(k + 5)));
    let draft = drafted(&lines("level,stamp,node,pos_x,pos_y", 10, quoted));
    says(&draft.toml, &["time = \"stamp\"", "[\"pos_x\", \"pos_y\"]"]);

    let thousands = drafted(&lines("t;price", 12, |k| format!("{k};1.2{:02},{}", k * 7 % 100, k % 10)));
    says(&thousands.toml, &["decimal = \",\"", "thousands = \".\""]);
    let row = thousands.filtered.table()[1].clone();
    assert_eq!(row[1].parse::<f64>().unwrap(), 1200.0, "{row:?}");
    let thousands = drafted(&lines("t,price", 12, |k| format!("{k},\"1,2{:02}.{}\"", k * 7 % 100, k % 10)));
    says(&thousands.toml, &["thousands = \",\""]);

    let mixed = lines("t;x;y", 20, |k| format!("{k};{};{}", wave(k), comma(wave(k))));
    says(&refused(&mixed), &["log.csv:", "decimal point", "decimal comma"]);
    let ragged = lines("t,z", 20, |k| format!("{k},1,{}", k % 9));
    says(&refused(&ragged), &["log.csv:2", "decimal commas?"]);
    let robot = |k: u32| format!("[INFO],\"[17849000{k:02},546481370]\",[logger],pos_x,\"{}\"", comma(wave(k)));
    let as_logged: String = (0..20).map(|k| robot(k) + "\n").collect();
    says(&refused(&as_logged), &["log.csv:1", "expected a header", "1784900000.546481370"]);
}

#[test]
fn without_its_key_a_decimal_comma_is_named_by_tune() {
    let folder = Folder::with_level();
    folder.write("log.csv", "t;z\n0,5;1,5\n1,5;2,5\n");
    says(&folder.run(&["filter", "problem.toml"]).refusal(), &["log.csv:2:1", "decimal = \",\""]);
    folder.write("problem.toml", LEVEL.replace("time = \"t\"", "time = \"t\"\ndecimal = \",\""));
    let table = folder.run(&["filter", "problem.toml", "--quiet"]).expect(0);
    assert!(table.stdout.contains("\n\"0,5\","), "the log's own text: {}", table.stdout);
}

#[test]
fn blanks_and_tabs_part_cells() {
    let draft = drafted(&lines("t   z", 40, |k| format!("  {k}   {:.3}", wave(k))));
    says(&draft.stderr, &["cells are parted by blanks"]);
    says(&draft.toml, &["separator = \" \"", "time = \"t\"", "[\"z\"]"]);
    // numpy.savetxt.
    let draft = drafted(&lines("# t z", 40, |k| format!("{k} {:.3}", wave(k))));
    says(&draft.toml, &["header_line = 1", "separator = \" \""]);
    says(&draft.filtered.stderr, &["40 rows"]);
    let draft = drafted(&lines("t\tz", 40, |k| format!("{k}\t{:.3}", wave(k))));
    assert!(!draft.toml.contains("separator"), "{}", draft.toml);
    let folder = Folder::with_level();
    folder.write("log.csv", "t z\n0 1\n1 2\n");
    says(&folder.run(&["filter", "problem.toml"]).refusal(), &["separator = \" \""]);
}

/// nll of the problem of [`LEVEL`] over a log, with a line more in `[data]`.
fn nll(log: &str, key: &str) -> f64 {
    let folder = Folder::new();
    folder.write(
        "problem.toml",
        LEVEL.replace("time = \"t\"", &format!("time = \"t\"\n{key}")).replace("\"q\"", "\"q*dt\""),
    );
    folder.write("log.csv", log);
    folder.run(&["filter", "problem.toml", "--json"]).expect(0).json()["objectives"]["nll"].as_f64().unwrap()
}

#[test]
fn epochs_in_fractions_of_a_second_are_seconds() {
    let seconds = nll(&lines("t,z", 60, |k| format!("{}.{:03},{}", k / 5, k % 5 * 200, wave(k))), "");
    for (key, digits) in [("ms", 0), ("us", 3), ("ns", 6)] {
        let stamp = |k: u32| format!("17000{:05}{:03}{}", k / 5, k % 5 * 200, "0".repeat(digits));
        let log = lines("t,z", 60, |k| format!("{},{}", stamp(k), wave(k)));
        let read = nll(&log, &format!("time_unit = \"{key}\""));
        assert_eq!(read, seconds, "{key}: the bits of the log that starts at 0");
        let draft = drafted(&log.replacen("t,", &format!("stamp_{key},"), 1));
        says(&draft.stderr, &["warning: column", &format!("time_unit = \"{key}\"")]);
        says(&draft.toml, &[&format!("\ntime_unit = \"{key}\"")]);
        says(&draft.filtered.stderr, &["dt: 0.2 s, regular"]);
        let folder = Folder::with_level();
        folder.write("log.csv", &log);
        let finished = folder.run(&["filter", "problem.toml"]).expect(0);
        says(&finished.stderr, &["warning: the times of", &format!("give time_unit = \"{key}\"")]);
    }
}

#[test]
fn digits_that_no_double_holds_count() {
    // 10 kHz, 1 kHz, 0.1 s and 3 s from 1.7e9 s, and 1 MHz in nanoseconds.
    for (step, decimals) in [(1_000_u64, 4), (10_000, 3), (1_000_000, 1), (30_000_000, 0)] {
        let at = |k: u32, start: u64| {
            let ticks = u64::from(k) * step;
            let text = format!("{}.{:07}", start + ticks / 10_000_000, ticks % 10_000_000);
            text[..text.len() - 7 + decimals].trim_end_matches('.').to_owned()
        };
        let log = |start: u64| lines("t,z", 300, |k| format!("{},{}", at(k, start), wave(k)));
        assert_eq!(nll(&log(1_700_000_000), ""), nll(&log(0), ""), "{decimals} decimals");
        let printed = lines("t,z", 300, |k| format!("{:.9},{}", at(k, 1_700_000_000).parse::<f64>().unwrap(), wave(k)));
        assert_eq!(nll(&printed, ""), nll(&log(0), ""), "a double's own digits, {decimals} decimals");
    }
    let nanoseconds = |start: &str| lines("t,z", 300, |k| format!("{start}.{:09},{}", k * 1_000 + 7, wave(k)));
    assert_eq!(nll(&nanoseconds("1700000000"), ""), nll(&nanoseconds("0"), ""), "nanoseconds");
    // A third of a second as doubles near 1.7e9 hold it.
    let thirds = lines("t,z", 300, |k| format!("{},{}", 1.7e9 + f64::from(k) / 3.0, wave(k)));
    let folder = Folder::with_level();
    folder.write("log.csv", thirds);
    says(&folder.run(&["filter", "problem.toml"]).expect(0).stderr, &["dt: 0.333333 s, regular"]);
}

#[test]
fn months_and_years_are_counted_by_the_calendar() {
    let month = |k: u32| format!("{}-{:02}-01,{}", 1990 + k / 12, k % 12 + 1, wave(k));
    let draft = drafted(&lines("date,co2", 60, month));
    says(&draft.toml, &["\ntime_unit = \"month\"", "unit^2/month"]);
    says(&draft.filtered.stderr, &["time 1990-01-01 to 1994-12-01 (59 months)", "dt: 1 month, regular"]);
    let draft = drafted(&lines("year,z", 60, |k| format!("{},{}", 1900 + k, wave(k))));
    says(&draft.filtered.stderr, &["time 1900 to 1959 years", "dt: 1 year, regular"]);
    let draft = drafted(&lines("date,z", 28, |k| format!("2024-02-{:02},{}", k + 1, wave(k))));
    says(&draft.filtered.stderr, &["dt: 1 day, regular"]);
    let off = lines("t,z", 3, |k| format!("2024-01-{:02},{}", 5 * k + 1, wave(k)));
    let folder = Folder::with_level();
    folder.write("log.csv", off);
    folder.write("problem.toml", LEVEL.replace("time = \"t\"", "time = \"t\"\ntime_unit = \"month\""));
    says(&folder.run(&["filter", "problem.toml"]).refusal(), &["log.csv:3:1", "expected day 1 of a month"]);
}

#[test]
fn sensors_that_never_report_together_start_at_their_own_first_values() {
    let log =
        lines(
            "t,a,b",
            200,
            |k| if k % 5 == 0 { format!("{k},,{}", 50 + k % 7) } else { format!("{k},{},", k * 3 % 7) },
        );
    let draft = drafted(&log);
    says(&draft.toml, &["x0 = [3.0, 50.0]"]);
    // One of several trajectories without a complete row.
    let log = lines("id,t,a,b", 60, |k| match k {
        0..30 => format!("1,{k},{},{}", wave(k), wave(k + 1)),
        _ => format!("2,{k},{}", if k % 2 == 0 { format!("{},", wave(k)) } else { format!(",{}", wave(k)) }),
    });
    assert!(!drafted(&log).toml.contains("\"measurement\""));
}

#[test]
fn filter_keeps_the_times_of_the_log() {
    let iso = |k: u32| format!("2021-06-07T05:59:{:02}+02:00", k);
    let folder = Folder::with_level();
    folder.write("log.csv", lines("t,z", 50, |k| format!("{},{}", iso(k), wave(k))));
    let finished = folder.run(&["filter", "problem.toml"]).expect(0);
    says(&finished.stderr, &["time 2021-06-07T05:59:00+02:00 to 2021-06-07T05:59:49+02:00 (49 s)"]);
    let table = finished.table();
    assert_eq!(table[0][0], "t");
    assert!((0..50).all(|k| table[k as usize + 1][0] == iso(k)), "{:?}", table[1]);
    folder.write("log.csv", "t,z\n0.50,1\n1.50,2\n2.5e0,3\n");
    let table = folder.run(&["filter", "problem.toml", "--quiet"]).expect(0).table();
    assert_eq!([&table[1][0], &table[2][0], &table[3][0]], ["0.50", "1.50", "2.5e0"]);
}

#[test]
fn a_log_in_place_of_a_problem_is_recognised() {
    let message = Folder::with_level().run(&["tune", "log.csv"]).refusal();
    says(&message, &["log.csv is a log", "`kfgpu init log.csv --out problem.toml`"]);
}

#[test]
fn degrees_and_inputs_are_named() {
    let degrees = |k: u32| format!("{k},{:.7},{:.7}", 48.2 + 1e-5 * wave(k), 16.37 - 1e-5 * wave(k + 4));
    let draft = drafted(&lines("t,Latitude,Longitude", 60, degrees));
    // WGS 84 at 48.2 degrees: 111.194 and 74.336 km.
    says(
        &draft.stderr,
        &["one of \"Latitude\" is 111194 m", "one of \"Longitude\" is 74336 m", "degrees are not metres"],
    );
    says(&draft.toml, &["degrees are not metres", "unit = \"deg^2\""]);
    let robot = |k: u32| format!("{k},{:.3},{:.3},{},{}", wave(k), wave(k + 2), k % 5, k % 3);
    let draft = drafted(&lines("t,x,y,wheel_left,throttle", 60, robot));
    says(&draft.stderr, &["\"wheel_left\", \"throttle\" are named like known inputs and left out"]);
    says(&draft.toml, &["measurements = [\"x\", \"y\"]", "wheel_left"]);
    let battery = |k: u32| format!("{k},{:.3},{:.4}", wave(k), 3.7 + 0.01 * wave(k));
    let draft = drafted(&lines("t,current,voltage", 60, battery));
    says(&draft.toml, &["measurements = [\"voltage\"]"]);
    says(&draft.stderr, &["\"voltage\"", "\"current\""]);
}

/// What `filter` warns of in the column z of a log.
fn warned(z: impl Fn(u32) -> String) -> String {
    let folder = Folder::with_level();
    folder.write("log.csv", lines("t,z", 300, |k| format!("{k},{}", z(k))));
    let stderr = folder.run(&["filter", "problem.toml"]).expect(0).stderr;
    stderr.lines().filter(|line| line.starts_with("warning: ")).collect::<Vec<_>>().join("\n")
}

#[test]
fn what_no_sensor_measured_is_named() {
    let sensor = |k: u32| format!("{:.3}", 47.0 + 0.1 * wave(k));
    let with = |rows: std::ops::Range<u32>, value: &'static str| {
        warned(move |k| if rows.contains(&k) { value.to_owned() } else { sensor(k) })
    };
    says(&with(100..103, "-9999"), &["\"z\" is -9999 in 3 rows, first in line 102", "empty the cells"]);
    says(&with(40..41, "1e30"), &["\"z\" is 1e30 in 1 row, first in line 42"]);
    says(&with(0..5, "0"), &["\"z\" is 0 in 5 rows, first in line 2"]);
    says(&with(150..180, "47.5"), &["stands at 47.5 for 30 rows from line 152"]);
    says(&with(200..201, "97.123"), &["leaps by", "in line 202 (1 such row)"]);
    let jump = warned(|k| format!("{:.3}", 47.0 + 0.1 * wave(k) + if k < 150 { 0.0 } else { 200.0 }));
    says(&jump, &["jumps by", "in line 152"]);
    let folder = Folder::with_level();
    folder
        .write("log.csv", lines("t,z", 300, |k| format!("{k},{}", if k == 9 { "-999".to_owned() } else { sensor(k) })));
    let finished = folder.run(&["init", "log.csv"]).expect(0);
    says(&finished.stderr, &["\"z\" is -999 in 1 row, first in line 11"]);
    says(&finished.stdout, &["# Note: column \"z\" is -999"]);
}

/// A declared input may be what a measurement jumps with.
#[test]
fn a_jump_beside_an_input_is_no_oddity() {
    let folder = Folder::with_level();
    let row = |k: u32| format!("{k},{:.3},{}", 47.0 + 0.1 * wave(k) + if k < 150 { 0.0 } else { 200.0 }, k / 150);
    folder.write("log.csv", lines("t,z,u", 300, row));
    let problem = |inputs: &str, h: &str| {
        format!(
            "[data]\nfile = \"log.csv\"\ntime = \"t\"\nmeasurements = [\"z\"]\n{inputs}\n[model]\nstate = [\"x\"]\nf = [\"x\"]\n\
             h = [\"{h}\"]\nQ = [\"q\"]\nR = [0.01]\nx0 = [47]\nP0 = [1]\n[parameters]\nq = {{ min = 0.001, max = 1 }}\n"
        )
    };
    folder.write("driven.toml", problem("inputs = [\"u\"]", "x + 200*u"));
    folder.write("alone.toml", problem("", "x"));
    let jumps = |file: &str| folder.run(&["filter", file]).expect(0).stderr.contains("jumps by");
    assert_eq!((jumps("driven.toml"), jumps("alone.toml")), (false, true));
}

#[test]
fn honest_sensors_raise_no_alarm() {
    let noise = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5;
    let none = |z: &dyn Fn(u32) -> String| assert_eq!(warned(z), "");
    none(&|k| format!("{:.1}", 21.3 + 0.1 * noise(k)));
    none(&|k| (k / 7).to_string());
    none(&|k| if (100..200).contains(&k) { "5".to_owned() } else { (5 + k % 2).to_string() });
    none(&|k| format!("{}", noise(k)));
    none(&|k| format!("{}", 9990.0 + 20.0 * noise(k)));
    none(&|k| format!("{}", f64::from(k * k) + noise(k)));
    none(&|k| if k < 9 { "0".to_owned() } else { format!("{:.4}", 0.01 * f64::from(k - 9) + 0.02 * noise(k)) });
    none(&|_| "0".to_owned());
}
