use super::*;

#[test]
fn nothing_of_the_users_is_markup() {
    assert_eq!(plain("a|b_c*d`e\n<f>"), "a\\|b\\_c\\*d\\`e \\<f\\>");
}

#[test]
fn tables_leave_out_empty_columns_and_align_numbers() {
    let rows = [["q", "", "1.5"], ["r", "", "-2"]].map(|row| row.map(str::to_owned).to_vec());
    assert_eq!(
        table(&["parameter", "unit", "tuned"], &rows),
        "| parameter | tuned |\n| --- | ---: |\n| q | 1.5 |\n| r | -2 |"
    );
}
