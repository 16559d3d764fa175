"use strict";
// Views: the contents of the sections of the page, which views.json declares and pages.cmake inserts. A view shows
// rows of a family, in one of four charts:
//
//   "bars": key                      a bar for each row
//   "stacks": [key, by]              as above; stacks the rows that differ only in `by`
//   "lines": [by, x, title, key...]  a line for each value of `by`, over x; "dots": without lines
//
// Keys that the chart does not show become selections, as do "fields" if there are several; an array within them is
// a stack. "where", "except", "with" and "without" select rows by the values of members, or by their presence.

const unit_of = (list, field) => field === "real_time" ? `time, ${list[0]?.time_unit}` : label(field);

const draw_bars = (key) => ({keys: [key], draw: (list, field) =>
  bars(list, key, [field].flat(), Array.isArray(field) ? "sum of the parts" : unit_of(list, field))});
const draw_curves = ([by, x, title, ...also], line) => ({keys: [by, x, ...also], draw: (list, field) =>
  curves(list, by, x, field, title, unit_of(list, field), line)});
const draw_stacks = ([key, by]) => ({keys: [key, by], draw: (list, field) => {
  const merged = distinct(list, key).map((name) => Object.assign({[key]: name, run_name: name},
    ...list.filter((row) => row[key] === name).map((row) => ({[row[by]]: row[field]}))));
  return bars(merged, key, distinct(list, by), unit_of(list, field));
}});
const chart_of = (view) =>
  view.bars ? draw_bars(view.bars) : view.stacks ? draw_stacks(view.stacks) : draw_curves(view.lines ?? view.dots, !!view.lines);

const rows_of = ({family, where = {}, except, with: needed, without}) => rows(family, where).filter((row) =>
  !(except && has_all(row, except)) && !(needed && !(needed in row)) && !(without in row));

const views = @views@.map((view) => ({...view, ...chart_of(view)}));
