function run = load_run (path)
% A result file as a struct, for MATLAB and for Octave (with its package netcdf).
%
% run.NAME is a dataset: a row a sample, event, contact or peak, a column an item. HDF5 readers of
% MATLAB and Octave give the dimensions the other way round; here they are put right. run.names
% tells the items: run.names.clearance is {'A', 'B'} if the columns of run.normal_force are these.
  if exist ('OCTAVE_VERSION', 'builtin')
    pkg load netcdf
  end
  info = ncinfo (path);
  for k = 1:numel (info.Variables)
    name = info.Variables(k).Name;
    values = double (ncread (path, name));
    if numel (info.Variables(k).Dimensions) == 2
      values = values.';
    end
    run.(name) = values;
  end
  for kind = {'body', 'joint', 'clearance', 'drive'}
    run.names.(kind{1}) = {};
    if ~isempty (run.(kind{1}))
      run.names.(kind{1}) = strsplit (ncreadatt (path, kind{1}, 'flag_meanings'), ' ');
    end
  end
  run.title = ncreadatt (path, '/', 'title');
end
