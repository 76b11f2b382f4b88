//! Words of messages: input cut short, so that an error is one sentence whatever it is about, and numbers of things.

/// Characters of a value that a message repeats.
const LONGEST: usize = 60;

/// At most 60 characters of a text that the user gave, on one line.
pub(crate) fn shorten(text: &str) -> String {
    let mut characters = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let short: String = characters.by_ref().take(LONGEST).collect();
    if characters.next().is_some() { short + "..." } else { short }
}

/// As many of these, each shortened, as a sentence holds.
#[cfg(any(feature = "cli", test))]
pub(crate) fn listed<S: AsRef<str>>(items: impl IntoIterator<Item = S>) -> String {
    const MOST: usize = 8;
    let mut items = items.into_iter();
    let mut shown: Vec<String> = items.by_ref().take(MOST).map(|item| shorten(item.as_ref())).collect();
    let more = items.count();
    if more > 0 {
        shown.push(format!("and {more} more"));
    }
    shown.join(", ")
}

/// "a", "a and b", "a, b and c".
pub(crate) fn enumerated<S: AsRef<str>>(items: &[S]) -> String {
    let items: Vec<&str> = items.iter().map(AsRef::as_ref).collect();
    match items[..] {
        [] => String::new(),
        [one] => one.to_owned(),
        [ref first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// So many of what `one` of is called, with an s unless it is one: `1 thread`, `2 threads`, `0 rows`.
pub(crate) fn counted(count: usize, one: &str) -> String {
    format!("{count} {one}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_is_cut_and_stays_on_one_line() {
        assert_eq!(shorten("r = 1"), "r = 1");
        assert_eq!(shorten(&"ü".repeat(60)), "ü".repeat(60));
        assert_eq!(shorten(&"ü".repeat(61)), "ü".repeat(60) + "...");
        assert_eq!(shorten("two\nlines\u{1b}[31m"), "two lines [31m");
    }

    #[test]
    fn one_thing_has_no_s() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "row")), ["0 rows", "1 row", "2 rows"]);
    }

    #[test]
    fn the_last_of_a_list_follows_an_and() {
        let lists = [&[][..], &["a"], &["a", "b"], &["a", "b", "c"]];
        assert_eq!(lists.map(enumerated), ["", "a", "a and b", "a, b and c"]);
    }

    #[test]
    fn a_long_list_is_counted() {
        assert_eq!(listed(["q", "r"]), "q, r");
        assert_eq!(listed((0..20).map(|i| i.to_string())), "0, 1, 2, 3, 4, 5, 6, 7, and 12 more");
        assert!(listed(vec!["x".repeat(1000); 1000]).chars().count() < 600);
    }
}
