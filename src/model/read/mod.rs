//! A problem file to a [`Problem`]: one file a table.

mod built_in;
mod constraints;
mod covariance;
mod data;
mod filter;
mod format;
mod lets;
mod locate;
mod model;
mod modes;
mod named_sensor;
mod names;
mod node;
mod objectives;
mod observation;
mod parameters;
mod pick;
mod sensor;
mod simulate;
mod tune;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use toml::de::DeTable;

use super::error::{Cause, Fault};
use super::{Problem, ProblemError, Span, definite};
use node::Fields;

pub(super) use locate::locate;

/// Bytes of a problem file.
const MAX_BYTES: u64 = 4 * 1024 * 1024;
const TABLES: [&str; 8] = ["data", "sensor", "model", "parameters", "filter", "mode", "tune", "simulate"];

impl Problem {
    /// Reads a problem file.
    ///
    /// # Errors
    /// If the file cannot be read, is larger than 4 MB or not text, or [`Self::parse`] refuses it.
    pub fn open(path: &Path) -> Result<Self, ProblemError> {
        let source = path.display().to_string();
        let fail = |cause| ProblemError::whole(&source, cause);
        let unreadable = |e: std::io::Error| fail(Cause::Unreadable { message: e.to_string() });
        let mut bytes = Vec::new();
        let file = File::open(path).map_err(unreadable)?;
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > MAX_BYTES {
            let actual = std::fs::metadata(path).map_or(MAX_BYTES + 1, |m| m.len());
            return Err(fail(Cause::FileTooLarge { bytes: actual, limit: MAX_BYTES }));
        }
        let text = String::from_utf8(bytes).map_err(|_| fail(Cause::NotText))?;
        Self::parse(&text, &source)
    }

    /// Reads the text of a problem file; `source` is its name in messages, and files of tables in formulas are looked for
    /// in its folder.
    ///
    /// ```
    /// let problem = kfgpu::model::Problem::parse(
    ///     r#"
    ///     [data]
    ///     file = "nile.csv"
    ///     measurements = ["volume"]
    ///     [model]
    ///     state = ["level"]
    ///     f = ["level"]
    ///     h = ["level"]
    ///     Q = ["q"]
    ///     R = ["r"]
    ///     x0 = [0]
    ///     P0 = [1e7]
    ///     [parameters]
    ///     q = { min = 1, max = 1e6, scale = "log" }
    ///     r = { min = 1, max = 1e6, scale = "log" }
    ///     "#,
    ///     "nile.toml",
    /// )?;
    /// assert_eq!(problem.parameters.names(), ["q", "r"]);
    /// # Ok::<(), kfgpu::model::ProblemError>(())
    /// ```
    ///
    /// # Errors
    /// One sentence with line, column and caret for the first thing that is wrong.
    pub fn parse(text: &str, source: &str) -> Result<Self, ProblemError> {
        if text.len() as u64 > MAX_BYTES {
            let cause = Cause::FileTooLarge { bytes: text.len() as u64, limit: MAX_BYTES };
            return Err(ProblemError::whole(source, cause));
        }
        read(text, source).map_err(|fault| fault.locate(source, text))
    }
}

fn read(text: &str, source: &str) -> Result<Problem, Fault> {
    let table = DeTable::parse(text).map_err(|error| {
        let span = error.span().map_or(Span::default(), |r| Span { start: r.start, end: r.end });
        // Parser messages may have several lines; the sentence takes the first.
        let message = error.message().lines().next().unwrap_or("syntax error").to_owned();
        Fault::new(span, Cause::Toml { message })
    })?;
    let document = Fields::document(table.get_ref(), text, &TABLES)?;
    let data = data::read(&document)?;
    let tables = modes::tables(&document)?;
    let draft = model::draft(&document, modes::common(&document, &tables)?, &data, None)?;
    data::check_truth(&document, draft.states())?;
    let modes = modes::drafts(&document, &draft, tables, &data)?;
    let declared = document.optional("parameters", |n| n.table("a table", &[]))?;
    let mut factors = draft.factors.clone();
    modes.iter().flat_map(|mode| &mode.draft.factors).try_for_each(|f| model::add_factor(&mut factors, f.clone()))?;
    let parameters = parameters::read(declared.as_ref(), &factors)?;
    let folder = Path::new(source).parent().unwrap_or_else(|| Path::new(""));
    let names = draft.names(&document, &data, &parameters, folder)?;
    let model = draft.finish(&document, &names, &data, &parameters)?;
    let modes = modes::read(&modes, &document, (&model, &data), (&parameters, folder))?;
    let simulate = simulate::read(&document, &model, &parameters, &names, &data)?;
    let tune = tune::tune(&document, &data, &model.states)?;
    let (filter, robust) = filter::read(&document, &model, &parameters, &names, modes.len())?;
    tune::check_robust(&document, &tune, robust.as_ref())?;
    let (source, text) = (source.to_owned(), text.to_owned());
    let mut problem = Problem { source, text, data, model, parameters, filter, robust, modes, tune, simulate };
    problem.data.readers = observation::readers(&problem);
    modes::check_objectives(&document, &problem)?;
    definite::check(&problem).map_err(|(path, cause)| Fault::new(locate(&problem.text, &path), cause))?;
    Ok(problem)
}
