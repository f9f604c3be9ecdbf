//! Reads MCAP files with ROS 2 messages in CDR, described by `.msg` text.

mod definition;
mod message;

use crate::log::{Cells, Column, Log};
use definition::Definitions;
use message::{Message, decoded};
use std::collections::BTreeMap;

/// Reads all supported messages. Each is a row, with the time in its header or, without one, the log time.
pub(super) fn read(bytes: &[u8]) -> Result<Log, String> {
    let failed = |error: mcap::McapError| error.to_string();
    let mut known: BTreeMap<u16, Result<Definitions, String>> = BTreeMap::new();
    let mut names: BTreeMap<String, usize> = BTreeMap::new();
    let mut rows: Vec<(i64, Vec<(usize, f64)>)> = Vec::new();
    let mut left_out: BTreeMap<String, String> = BTreeMap::new();
    for read in mcap::MessageStream::new(bytes).map_err(failed)? {
        let read = read.map_err(failed)?;
        let channel = &read.channel;
        let definitions = known.entry(channel.id).or_insert_with(|| {
            match (&channel.schema, channel.message_encoding.as_str()) {
                (Some(schema), "cdr") if schema.encoding == "ros2msg" => {
                    Definitions::parse(&schema.name, &schema.data)
                }
                (schema, other) => {
                    let schema = schema.as_ref().map_or("no", |schema| &schema.encoding);
                    Err(format!(
                        "its messages are {other} with {schema} schema, where only cdr with ros2msg is read"
                    ))
                }
            }
        });
        let message = definitions
            .as_ref()
            .map_err(Clone::clone)
            .and_then(|definitions| decoded(&read.data, definitions));
        let Message { stamp_ns, fields } = match message {
            Ok(message) => message,
            Err(why) => {
                left_out.entry(channel.topic.clone()).or_insert(why);
                continue;
            }
        };
        let logged_ns = i64::try_from(read.log_time).unwrap_or(i64::MAX);
        let cells = fields.into_iter().map(|(name, value)| {
            let count = names.len();
            let column = names
                .entry(format!("{}.{name}", channel.topic))
                .or_insert(count);
            (*column, value)
        });
        rows.push((
            stamp_ns.filter(|stamp| *stamp > 0).unwrap_or(logged_ns),
            cells.collect(),
        ));
    }
    if rows.is_empty() {
        return Err(match left_out.first_key_value() {
            Some((topic, why)) => {
                format!("no topic can be read; {topic}: {why}, as ROS 2 records")
            }
            None => "there are no messages in it".into(),
        });
    }
    rows.sort_by_key(|(at, _)| *at);
    let mut columns = vec![vec![f64::NAN; rows.len()]; names.len()];
    for (row, (_, cells)) in rows.iter().enumerate() {
        for (column, value) in cells {
            columns[*column][row] = *value;
        }
    }
    let mut log = Log::default();
    let stamps = rows.iter().map(|(at, _)| Some(*at)).collect();
    log.columns
        .push(Column::new("time [ns]".into(), Cells::Whole(stamps)));
    log.columns.extend(
        names
            .into_iter()
            .map(|(name, column)| Column::numbers(name, std::mem::take(&mut columns[column]))),
    );
    log.notes.extend(
        left_out
            .into_iter()
            .map(|(topic, why)| format!("topic {topic} is left out: {why}")),
    );
    Ok(log)
}
