//! The words of a report, for somebody who has not seen them.

use crate::report::Tuning;
use crate::report::document::{Part, Section};

pub(super) fn of(tuning: &Tuning) -> Section {
    let explained = |name: &str| match name {
        "nll" => Some("`nll`: negative log-likelihood, how unlikely the measurements are to the filter [nats]"),
        "mse_innovation" => Some("`mse_innovation`: mean squared innovation"),
        "mismatch" => Some("`mismatch`: how far the size of the innovations is from what the filter computes for it"),
        "nis" => Some("`nis`: distance of the mean NIS from 1"),
        "nees" => Some("`nees`: distance of the mean NEES from 1"),
        "rmse" => Some("`rmse`: root mean squared error of the estimate against the true states"),
        "distance" => Some("`distance`: summed error of the estimate against the true states"),
        _ => None,
    };
    let mut lines: Vec<&str> = tuning.objectives.iter().filter_map(|(name, _)| explained(name)).collect();
    lines.extend([
        "innovation: a measurement less what the filter predicted for it",
        "NIS: squared innovation in units of its own variance; 1 on average when the filter knows its errors",
        "F, H, Q, R, K: transition, measurement, process noise, measurement noise and gain of the filter",
        "f64 reference: a filter in double precision that shares no code with that of the search",
    ]);
    if tuning.matrices.f0.is_some() || tuning.matrices.h0.is_some() {
        lines.push("f0, h0: what transition and measurement add that no state is part of");
    }
    if tuning.matrices.f.is_some() || tuning.matrices.h.is_some() {
        lines.push("f, h: transition and measurement as functions of the states, where these are no matrices");
    }
    if tuning.consistency.nees.is_some() {
        lines.push("NEES: squared error of the estimate in units of its own variance, where the truth is known");
    }
    let list = lines.into_iter().map(|line| (String::new(), format!("{line}."))).collect();
    Section::new("Words").on_page(Part::List(list))
}
